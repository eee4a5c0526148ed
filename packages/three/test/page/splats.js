// Gaussian splats of the example, as numbers.

import * as THREE from 'three/webgpu';
import { pass } from 'three/tsl';
import { cloud, glass, splatScene } from '../../example/splats/scene.js';
import { SPLAT_BYTES, createSplats, splatsFrom } from '../../example/splats/splats.js';
import { aspect, drawn, modelOf } from './helpers.js';
import { HEIGHT, WIDTH, errors, imageOf, makeRenderer, peeled, shown } from './measure.js';
import { perspective, random } from './scenes.js';

/** Bytes of a `.splat` file, of objects. */
function bytesOf( splats ) {

	const buffer = new ArrayBuffer( splats.length * SPLAT_BYTES );
	const view = new DataView( buffer );

	splats.forEach( ( { center, scale, color, rotation: [ w, x, y, z ] }, i ) => {

		[ ...center, ...scale ].forEach( ( value, k ) => view.setFloat32( i * SPLAT_BYTES + 4 * k, value, true ) );
		[ ...color, ...[ w, x, y, z ].map( ( value ) => Math.min( Math.round( 128 + 128 * value ), 255 ) ) ].forEach( ( value, k ) => view.setUint8( i * SPLAT_BYTES + 24 + k, value ) );

	} );

	return buffer;

}

// The same splats, drawn in another order.
function shuffled( buffer ) {

	const next = random( 3 );
	const bytes = new Uint8Array( buffer.slice() );
	const splat = ( i ) => bytes.subarray( i * SPLAT_BYTES, ( i + 1 ) * SPLAT_BYTES );

	for ( let i = bytes.length / SPLAT_BYTES - 1; i > 0; i -- ) {

		const j = Math.floor( next() * ( i + 1 ) );
		const kept = splat( i ).slice();

		splat( i ).set( splat( j ) );
		splat( j ).set( kept );

	}

	return bytes.buffer;

}

const sceneOf = ( buffer ) => splatScene( createSplats( splatsFrom( buffer ) ) );

// The example's scene with those of its transparent objects alone of which `keeps` is true: the splats, and then the panes.
function sceneWith( keeps ) {

	const scene = sceneOf( cloud() );
	const transparent = scene.children.filter( ( { material } ) => material.transparent );

	return scene.remove( ...transparent.filter( ( _, i ) => keeps( i ) === false ) );

}

// How many pixels of all differ by more than so many steps.
function fractionBeyond( steps, image, other ) {

	let count = 0;

	for ( let i = 0; i < image.length; i += 4 ) if ( [ 0, 1, 2 ].some( ( k ) => Math.abs( shown( image[ i + k ] ) - shown( other[ i + k ] ) ) > steps ) ) count ++;

	return 4 * count / image.length;

}

/** What a file's bytes are read as. */
export async function splatsRead() {

	const { count, centers, scales, rotations, colors } = splatsFrom( bytesOf( [
		{ center: [ 1, 2, 3 ], scale: [ 0.5, 0.25, 0.125 ], color: [ 10, 20, 30, 40 ], rotation: [ 0.5, - 0.5, 0.5, - 0.5 ] },
		{ center: [ - 1, 0, 0 ], scale: [ 1, 1, 1 ], color: [ 255, 0, 0, 255 ], rotation: [ - 1, 0, 0, 0 ] }
	] ) );

	return { count, centers: [ ...centers ], scales: [ ...scales ], rotations: [ ...rotations ], colors: [ ...colors ] };

}

/** The example's scene against the exact image, in another order of the splats, and without the splats and each pane. */
export async function splatImages( backend, { models = [ 'medium' ], steps = 5 } = {} ) {

	const renderer = await makeRenderer( backend );
	const camera = perspective( aspect );
	const scene = sceneOf( cloud() );
	const exact = await peeled( renderer, scene, camera, 256 );
	const result = { layers: exact.layers, problems: [], unsorted: errors( await imageOf( renderer, pass( scene, camera ) ), exact.image ), models: {} };

	for ( const name of models ) {

		const model = await modelOf( name );
		const draw = async ( drawnScene ) => {

			const { image, node, problems } = await drawn( renderer, drawnScene, camera, { model } );

			node.dispose();
			result.problems.push( ...problems );

			return image;

		};
		const image = await draw( scene );
		const reordered = await draw( sceneOf( shuffled( cloud() ) ) );
		const without = [];

		for ( let left = 0; left <= glass().length; left ++ ) without.push( errors( await draw( sceneWith( ( i ) => i !== left ) ), image ).rmse );

		result.models[ name ] = { exact: errors( image, exact.image ), reordered: { ...errors( reordered, image ), beyond: fractionBeyond( steps, reordered, image ) }, without };

	}

	renderer.dispose();

	return result;

}

/** A splat between two panes, all facing the camera: the colour in the middle of the image, and that of the three layers by hand. */
export async function splatBetween( backend, { name = 'medium', color: [ r, g, b, a ] = [ 200, 100, 50, 128 ] } = {} ) {

	const renderer = await makeRenderer( backend );
	const camera = new THREE.PerspectiveCamera( 40, aspect, 0.1, 100 );
	const scene = new THREE.Scene();
	const splats = createSplats( splatsFrom( bytesOf( [ { center: [ 0, 0, 0 ], scale: [ 20, 20, 0.01 ], color: [ r, g, b, a ], rotation: [ 1, 0, 0, 0 ] } ] ) ) );
	const looks = [ { z: 1, rgb: [ 0.1, 0.5, 0.9 ], opacity: 0.4 }, { z: - 1, rgb: [ 0.9, 0.8, 0.1 ], opacity: 0.7 } ];

	camera.position.z = 6;
	scene.background = new THREE.Color( 0.2, 0.2, 0.2 );
	scene.add( splats );

	for ( const { z, rgb, opacity } of looks ) {

		const pane = new THREE.Mesh( new THREE.PlaneGeometry( 20, 20 ), new THREE.MeshBasicMaterial( { color: new THREE.Color( ...rgb ), opacity, transparent: true } ) );

		pane.position.z = z;
		scene.add( pane );

	}

	const { image, problems } = await drawn( renderer, scene, camera, { model: await modelOf( name ) } );
	const at = 4 * ( HEIGHT / 2 * WIDTH + WIDTH / 2 );
	const { r: red, g: green, b: blue } = new THREE.Color().setRGB( r / 255, g / 255, b / 255, THREE.SRGBColorSpace );
	const layers = [ looks[ 0 ], { rgb: [ red, green, blue ], opacity: Math.min( a / 255, 0.99 ) }, looks[ 1 ] ];
	const expected = layers.reduceRight( ( below, { rgb, opacity } ) => below.map( ( value, k ) => value * ( 1 - opacity ) + opacity * rgb[ k ] ), [ 0.2, 0.2, 0.2 ] );

	renderer.dispose();

	return { problems, found: [ ...image.slice( at, at + 3 ) ], expected };

}

/**
 * A flat splat that is turned about y, small on the screen: its opacity along the middle row of pixels against the Gaussian's, and its depth
 * against its plane's, at pixels left of, at and right of its centre. With `isScaled` the mesh's matrix makes half of its size.
 */
export async function splatShape( backend, { angle = 0.8, isOrthographic = false, x = 0, isScaled = false } = {} ) {

	const renderer = await makeRenderer( backend );
	const height = 2.4;
	const camera = isOrthographic ? new THREE.OrthographicCamera( - height * aspect, height * aspect, height, - height, 0.1, 10 ) : new THREE.PerspectiveCamera( 40, aspect, 0.1, 100 );
	const scene = new THREE.Scene();
	const size = isScaled ? 0.5 : 1;
	const splats = createSplats( splatsFrom( bytesOf( [ { center: [ x / size, 0, 0 ], scale: [ 0.4 / size, 0.2 / size, 0.0001 ], color: [ 255, 255, 255, 204 ], rotation: [ Math.cos( angle / 2 ), 0, Math.sin( angle / 2 ), 0 ] } ] ) ) );

	splats.scale.setScalar( size );
	camera.position.z = 6;
	scene.background = new THREE.Color( 0, 0, 0 );
	scene.add( splats );

	const { image, node, problems } = await drawn( renderer, scene, camera, { model: await modelOf( 'medium' ), depthThreshold: 0.01 } );
	const written = await imageOf( renderer, node.getTextureNode( 'depth' ) );
	const { near, far } = camera;
	// As depth is kept, 0 at near to 1 at far.
	const distance = ( kept ) => isOrthographic ? near + kept * ( far - near ) : near * far / ( far - kept * ( far - near ) );

	// The rotation of the file is rounded to steps of 1/128.
	const [ w, , y ] = [ Math.cos( angle / 2 ), 0, Math.sin( angle / 2 ) ].map( ( value ) => Math.round( 128 * value ) );
	const turn = 2 * Math.atan2( y, w );
	const [ cos, sin ] = [ Math.cos( turn ), Math.sin( turn ) ];
	const focal = isOrthographic ? HEIGHT / ( 2 * height ) : HEIGHT / ( 2 * Math.tan( THREE.MathUtils.degToRad( 20 ) ) );
	const slant = isOrthographic ? 0 : x / 6;
	// Pixels by world space, at the centre; along the row.
	const scale = isOrthographic ? focal : focal / 6;
	const variance = ( scale * 0.4 * ( cos + slant * - sin ) ) ** 2 + 0.3;
	const across = ( scale * 0.2 ) ** 2 + 0.3;
	const pixels = [];

	for ( const offset of [ - 25, - 10, 0, 10, 25 ] ) {

		const column = Math.round( WIDTH / 2 + scale * x + offset );
		const dx = column + 0.5 - WIDTH / 2 - scale * x;
		const dy = 0.5;
		// The ray of the pixel meets the plane through the centre, of tangent cos, 0, -sin.
		const ray = ( column + 0.5 - WIDTH / 2 ) / focal;
		const depth = isOrthographic ? 6 + ( ray - x ) * sin / cos : ( 6 * cos - x * sin ) / ( cos - ray * sin );
		const at = 4 * ( HEIGHT / 2 * WIDTH + column );

		pixels.push( { found: [ image[ at ], distance( written[ at ] ) ], expected: [ 0.8 * Math.exp( - 0.5 * ( dx * dx / variance + dy * dy / across ) ), depth ] } );

	}

	renderer.dispose();

	return { problems, pixels };

}
