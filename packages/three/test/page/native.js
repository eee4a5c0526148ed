// The same meshes and camera in the page and in the native renderer.

import * as THREE from 'three/webgpu';
import { GLTFExporter } from 'three/addons/exporters/GLTFExporter.js';
import { pass } from 'three/tsl';
import { aspect, drawn, modelOf } from './helpers.js';
import { HEIGHT, WIDTH, errors, imageOf, makeRenderer, peeled } from './measure.js';
import { fifty, perspective } from './scenes.js';

const BACKGROUND = [ 0.03, 0.035, 0.045 ];

// Fifty objects without light: two renderers shade alike only where there is nothing to shade.
function unlit() {

	const scene = fifty();

	scene.background = new THREE.Color( ...BACKGROUND );

	scene.traverse( ( object ) => {

		if ( object.isLight === true ) object.visible = false;
		if ( object.isMesh !== true ) return;

		const { color, opacity, transparent, side } = object.material;

		object.material = new THREE.MeshBasicMaterial( { color, opacity, transparent, side } );

	} );

	return scene;

}

const base64 = ( bytes ) => {

	let text = '';

	for ( const byte of bytes ) text += String.fromCharCode( byte );

	return btoa( text );

};

/** The scene as the native renderer reads it: a GLB, and the numbers around it. */
export async function exportedScene() {

	const scene = unlit();

	scene.background = null;

	const meshes = new THREE.Scene();

	meshes.add( ...scene.children.filter( ( object ) => object.isMesh === true ) );

	const glb = await new GLTFExporter().parseAsync( meshes, { binary: true } );
	const camera = perspective( aspect );
	const target = camera.getWorldDirection( new THREE.Vector3() ).add( camera.position );

	return {
		glb: base64( new Uint8Array( glb ) ), background: BACKGROUND, size: [ WIDTH, HEIGHT ],
		camera: { position: camera.position.toArray(), target: target.toArray(), fov_y: camera.fov, near: camera.near, far: camera.far }
	};

}

// A PNG's colours, linear, in the order of a target's rows.
async function linear( png ) {

	const bytes = Uint8Array.from( atob( png ), ( c ) => c.charCodeAt( 0 ) );
	const bitmap = await createImageBitmap( new Blob( [ bytes ], { type: 'image/png' } ), { colorSpaceConversion: 'none' } );
	const context = new OffscreenCanvas( bitmap.width, bitmap.height ).getContext( '2d' );

	context.drawImage( bitmap, 0, 0 );

	const { data } = context.getImageData( 0, 0, bitmap.width, bitmap.height );
	const color = new THREE.Color();
	const image = new Float32Array( data.length );

	for ( let i = 0; i < data.length; i += 4 ) {

		color.setRGB( data[ i ] / 255, data[ i + 1 ] / 255, data[ i + 2 ] / 255, THREE.SRGBColorSpace );
		image.set( [ color.r, color.g, color.b, 1 ], i );

	}

	return image;

}

/** Differences from the native renderer's images: of exact ones, of each model's, and of drawings without transparency. */
export async function againstNative( backend, { images } ) {

	const renderer = await makeRenderer( backend );
	const scene = unlit();
	const camera = perspective( aspect );
	const result = { problems: [] };

	for ( const [ name, png ] of Object.entries( images ) ) {

		const native = await linear( png );

		if ( name === 'exact' ) {

			result.exact = errors( ( await peeled( renderer, scene, camera ) ).image, native );
			result.sorted = errors( await imageOf( renderer, pass( scene, camera ) ), native );

		} else {

			const { image, node, problems } = await drawn( renderer, scene, camera, { model: await modelOf( name ) } );

			result[ name ] = errors( image, native );
			result.problems.push( ...problems );
			node.dispose();

		}

	}

	renderer.dispose();

	return result;

}
