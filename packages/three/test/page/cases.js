// What the tests ask of a page, by name. Each returns numbers and texts; the tests judge them.

import * as THREE from 'three/webgpu';
import { pass, renderOutput, screenUV, texture, vec2 } from 'three/tsl';
import { oitPass } from 'three/addons/tsl/display/OITPassNode.js';
import { peelnetPass } from '@peelnet/three';
import { HEIGHT, WIDTH, errors, frameTime, imageOf, makeRenderer, peeled } from './measure.js';
import * as scenes from './scenes.js';

const modelOf = async ( name ) => ( await import( `@peelnet/three/models/${ name }.js` ) ).default;

const aspect = WIDTH / HEIGHT;

/** Errors of three.js's two methods and of this one, on a scene. */
export async function compared( backend, { scene: name = 'fifty', camera: cameraName = 'perspective', models = [ 'medium' ], ranges = [ 'pixel' ] } ) {

	const renderer = await makeRenderer( backend );
	const scene = scenes[ name ]();
	const camera = scenes[ cameraName ]( aspect );
	const problems = [];
	const exact = await peeled( renderer, scene, camera );
	const result = { layers: exact.layers, problems };

	const measure = async ( key, node ) => {

		result[ key ] = errors( await imageOf( renderer, node ), exact.image );
		node.dispose();

	};

	await measure( 'sorted', pass( scene, camera ) );
	await measure( 'weighted', oitPass( scene, camera ) );

	for ( const model of models ) {

		for ( const range of ranges ) {

			await measure( `${ model }:${ range }`, peelnetPass( scene, camera, { model: await modelOf( model ), range, onProblem: ( message ) => problems.push( message ) } ) );

		}

	}

	renderer.dispose();

	return result;

}

/**
 * Times of a frame, each method in turn for several rounds, so that a machine that slows down slows all of them. Every ratio is
 * of one round; the median of the rounds is returned.
 */
export async function timed( backend, { scene: name = 'fifty', models = [ 'medium' ], ranges = [ 'pixel', 'frame' ], rounds = 7, frames = 5, width = 640, height = 480 } ) {

	const renderer = await makeRenderer( backend );

	renderer.setSize( width, height );

	const scene = scenes[ name ]();
	const camera = scenes.perspective( width / height );
	const nodes = { sorted: pass( scene, camera ), weighted: oitPass( scene, camera ) };

	for ( const model of models ) for ( const range of ranges ) nodes[ `${ model }:${ range }` ] = peelnetPass( scene, camera, { model: await modelOf( model ), range } );

	const pipelines = Object.entries( nodes ).map( ( [ key, node ] ) => [ key, new THREE.RenderPipeline( renderer, node ) ] );
	const times = Object.fromEntries( pipelines.map( ( [ key ] ) => [ key, [] ] ) );

	for ( let round = 0; round <= rounds; round ++ ) {

		for ( const [ key, pipeline ] of pipelines ) {

			const time = await frameTime( renderer, () => pipeline.render(), frames );

			// The first round compiles.
			if ( round > 0 ) times[ key ].push( time );

		}

	}

	const median = ( values ) => values.sort( ( a, b ) => a - b )[ Math.floor( values.length / 2 ) ];
	const ratios = Object.fromEntries( Object.keys( times ).map( ( key ) => [ key, median( times[ key ].map( ( time, i ) => time / times.weighted[ i ] ) ) ] ) );
	const ms = Object.fromEntries( Object.keys( times ).map( ( key ) => [ key, median( [ ...times[ key ] ] ) ] ) );

	renderer.dispose();

	return { ms, ratios };

}

const drawn = async ( renderer, scene, camera, options, frames ) => {

	const problems = [];
	const node = peelnetPass( scene, camera, { onProblem: ( message ) => problems.push( message ), ...options } );
	const image = await imageOf( renderer, node, frames );

	return { image, node, problems };

};

/** How far the first frame is from the third: a target's first drawing must not clear what others share. */
export async function firstFrame( backend ) {

	const renderer = await makeRenderer( backend );
	const scene = scenes.fifty();
	const camera = scenes.perspective( aspect );
	const model = await modelOf( 'medium' );
	const first = await drawn( renderer, scene, camera, { model }, 1 );
	const third = await drawn( renderer, scene, camera, { model }, 3 );

	return errors( first.image, third.image );

}

/** How far the image is from that of the same objects in the opposite order, and from one drawn with three.js's sorting off. */
export async function order( backend ) {

	const renderer = await makeRenderer( backend );
	const scene = scenes.fifty();
	const camera = scenes.perspective( aspect );
	const model = await modelOf( 'medium' );
	const one = await drawn( renderer, scene, camera, { model } );

	scene.children.reverse();

	const other = await drawn( renderer, scene, camera, { model } );

	return errors( one.image, other.image );

}

/** A pass whose canvas changes its size, against a new pass of that size; and two cameras of one scene in one frame. */
export async function resized( backend ) {

	const renderer = await makeRenderer( backend );
	const scene = scenes.fifty();
	const camera = scenes.perspective( aspect );
	const model = await modelOf( 'medium' );
	const node = peelnetPass( scene, camera, { model } );
	const sizes = [];

	renderer.setSize( WIDTH / 2, HEIGHT / 2 );
	await imageOf( renderer, node );
	sizes.push( node._stages.passes.map( ( { target } ) => target.width ) );
	renderer.setSize( WIDTH, HEIGHT );

	const image = await imageOf( renderer, node, 1 );

	sizes.push( node._stages.passes.map( ( { target } ) => target.width ) );

	const fresh = await drawn( renderer, scene, camera, { model } );

	// The same pass with another camera, and back.
	node.camera = scenes.orthographic( aspect );

	const parallel = await imageOf( renderer, node );
	const freshParallel = await drawn( renderer, scene, node.camera, { model } );

	node.camera = camera;

	const back = await imageOf( renderer, node );

	return { sizes, resized: errors( image, fresh.image ), parallel: errors( parallel, freshParallel.image ), cameras: errors( back, parallel ), back: errors( back, fresh.image ) };

}

/** The image after tone mapping, against the exact image through the same tone mapping. */
export async function toneMapped( backend ) {

	const renderer = await makeRenderer( backend );
	const scene = scenes.fifty();
	const camera = scenes.perspective( aspect );
	const exact = await peeled( renderer, scene, camera );
	const data = new THREE.DataTexture( Float32Array.from( exact.image ), WIDTH, HEIGHT, THREE.RGBAFormat, THREE.FloatType );

	data.needsUpdate = true;

	const mapped = async ( node ) => imageOf( renderer, renderOutput( node, THREE.ACESFilmicToneMapping, THREE.LinearSRGBColorSpace ) );
	const target = vec2( screenUV.x, backend === 'webgl2' ? screenUV.y.oneMinus() : screenUV.y );
	const model = await modelOf( 'medium' );
	const plain = errors( await imageOf( renderer, texture( data, target ) ), exact.image );

	return { plain, mapped: errors( await mapped( peelnetPass( scene, camera, { model } ) ), await mapped( texture( data, target ) ) ) };

}

/** A premultiplied material shows the same as a straight one. */
export async function premultiplied( backend ) {

	const renderer = await makeRenderer( backend );
	const camera = scenes.perspective( aspect );
	const model = await modelOf( 'medium' );
	const near = { color: 0xff4020, opacity: 0.6 };
	const far = { color: 0x2040ff, opacity: 0.7 };
	const straight = await drawn( renderer, scenes.twoCards( { near, far } ), camera, { model } );
	const multiplied = await drawn( renderer, scenes.twoCards( { near: { ...near, premultipliedAlpha: true }, far } ), camera, { model } );

	return errors( multiplied.image, straight.image );

}

/** An additive material is drawn below, sorted, and the materials' own settings come back. */
export async function settings( backend ) {

	const renderer = await makeRenderer( backend );
	const scene = scenes.twoCards();
	const camera = scenes.perspective( aspect );
	const materials = scene.children.map( ( { material } ) => material );

	materials[ 0 ].depthWrite = true;
	materials[ 1 ].forceSinglePass = false;

	const state = () => JSON.stringify( [ materials.map( ( m ) => [ m.depthWrite, m.forceSinglePass, m.side, m.version ] ), renderer.sortObjects, renderer.opaque, renderer.transparent, renderer.autoClear, renderer.autoClearDepth, renderer.lighting.enabled, scene.background?.getHex(), camera.layers.mask, renderer.getMRT(), renderer.getRenderTarget() ] );
	const before = state();
	const { image, node } = await drawn( renderer, scene, camera, { model: await modelOf( 'medium' ) } );
	const after = state();

	// The far card adds: it is drawn into what lies below, and the near one over it.
	materials[ 1 ].blending = THREE.AdditiveBlending;
	materials[ 1 ].needsUpdate = true;

	const added = await imageOf( renderer, node );
	const sorted = await imageOf( renderer, pass( scene, camera ) );

	return { before, after, changed: errors( added, image ), added: errors( added, sorted ) };

}
