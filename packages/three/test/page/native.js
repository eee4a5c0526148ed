// The same meshes and camera in the page and in the native renderer.

import * as THREE from 'three/webgpu';
import { GLTFExporter } from 'three/addons/exporters/GLTFExporter.js';
import { pass } from 'three/tsl';
import { aspect, drawn, modelOf } from './helpers.js';
import { HEIGHT, WIDTH, errors, imageOf, makeRenderer, peeled, shown } from './measure.js';
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

// The root mean square of the differences of two errors, in steps of 255.
function apart( image, exact, native, nativeExact ) {

	let sum = 0;
	let count = 0;

	for ( let i = 0; i < exact.length; i ++ ) {

		if ( i % 4 === 3 ) continue;

		const page = shown( image[ i ] ) - shown( exact[ i ] );

		sum += ( page - ( shown( native[ i ] ) - shown( nativeExact[ i ] ) ) ) ** 2;
		count ++;

	}

	return Math.sqrt( sum / count );

}

// A PNG's colours, linear, in the order of a target's rows, which WebGL 2 reads from the bottom.
async function linear( png, backend ) {

	const bytes = Uint8Array.from( atob( png ), ( c ) => c.charCodeAt( 0 ) );
	const bitmap = await createImageBitmap( new Blob( [ bytes ], { type: 'image/png' } ), { colorSpaceConversion: 'none' } );
	const context = new OffscreenCanvas( bitmap.width, bitmap.height ).getContext( '2d' );

	if ( backend === 'webgl2' ) context.setTransform( 1, 0, 0, - 1, 0, bitmap.height );

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

/**
 * How far each model's errors, pixel by pixel, are from the native renderer's. Each is compared with its own exact image: along edges two
 * rasterisers disagree on which pixels a triangle covers, whatever is drawn there. `exact` is by how much.
 */
export async function againstNative( backend, { images } ) {

	const renderer = await makeRenderer( backend );
	const scene = unlit();
	const camera = perspective( aspect );
	const result = { problems: [], models: {} };
	const { exact: exactPng, ...pngs } = images;
	const exact = ( await peeled( renderer, scene, camera ) ).image;
	const nativeExact = await linear( exactPng, backend );

	result.exact = errors( exact, nativeExact );

	const compare = ( image, native ) => ( { apart: apart( image, exact, native, nativeExact ), page: errors( image, exact ).rmse, native: errors( native, nativeExact ).rmse } );

	for ( const [ name, png ] of Object.entries( pngs ) ) {

		const { image, node, problems } = await drawn( renderer, scene, camera, { model: await modelOf( name ) } );

		result.models[ name ] = compare( image, await linear( png, backend ) );
		result.problems.push( ...problems );
		node.dispose();

	}

	// What a wrong picture would give.
	result.sorted = compare( await imageOf( renderer, pass( scene, camera ) ), nativeExact );

	renderer.dispose();

	return result;

}
