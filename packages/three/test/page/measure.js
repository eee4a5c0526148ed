// Images as numbers, the exact reference, and errors.

import * as THREE from 'three/webgpu';
import { Discard, Fn, If, cameraProjectionMatrixInverse, ivec2, mrt, output, positionView, screenCoordinate, textureLoad, uniform, varying, vec4 } from 'three/tsl';

// Rows of 4-byte texels are then a multiple of 256 bytes, which WebGPU pads them to.
export const WIDTH = 320;
export const HEIGHT = 240;

export async function makeRenderer( backend, options = {} ) {

	const renderer = new THREE.WebGPURenderer( { antialias: false, forceWebGL: backend === 'webgl2', ...options } );

	renderer.setPixelRatio( 1 );
	renderer.setSize( WIDTH, HEIGHT );
	document.body.append( renderer.domElement );
	await renderer.init();

	if ( ( renderer.backend.isWebGPUBackend === true ) !== ( backend === 'webgpu' ) ) throw new Error( `The browser gave another back end than ${ backend }.` );

	return renderer;

}

const float = ( count ) => new THREE.RenderTarget( WIDTH, HEIGHT, { count, type: THREE.FloatType, minFilter: THREE.NearestFilter, magFilter: THREE.NearestFilter } );

const read = ( renderer, target, index = 0 ) => renderer.readRenderTargetPixelsAsync( target, 0, 0, target.width, target.height, index );

/**
 * Begins a frame, as the renderer does when the browser is about to draw. Without it a second drawing in the same frame would not
 * draw its passes again.
 */
export function nextFrame( renderer ) {

	renderer._nodes.nodeFrame.update();

}

/** The linear colours that a node shows, as RGBA. The second frame is read: the first may differ by what it initialises. */
export async function imageOf( renderer, node, frames = 2 ) {

	const target = float( 1 );
	const pipeline = new THREE.RenderPipeline( renderer, node );

	pipeline.outputColorTransform = false;

	for ( let i = 0; i < frames; i ++ ) {

		nextFrame( renderer );
		renderer.setRenderTarget( target );
		pipeline.render();
		renderer.setRenderTarget( null );

	}

	const pixels = await read( renderer, target );

	pipeline.dispose();
	target.dispose();

	return pixels;

}

/**
 * The exact image, by peeling: layer after layer of the nearest fragments behind the last layer, composited here in 64 bits.
 */
export async function peeled( renderer, scene, camera, mostLayers = 64 ) {

	const targets = [ float( 2 ), float( 2 ) ];
	const opaque = float( 2 );

	for ( const target of [ opaque, ...targets ] ) [ 'layer', 'distance' ].forEach( ( name, i ) => ( target.textures[ i ].name = name ) );

	// Along the view axis, of where the material puts its vertices.
	const distance = Fn( ( { material } ) => {

		if ( material.vertexNode?.isNode !== true ) return positionView.z.negate();

		const view = cameraProjectionMatrixInverse.mul( varying( vec4( material.vertexNode ) ) );

		return view.z.div( view.w ).negate();

	} )();
	const texel = ivec2( screenCoordinate.xy );
	const previous = textureLoad( targets[ 1 ].textures[ 1 ], texel );
	const solid = textureLoad( opaque.textures[ 1 ], texel );
	const behind = uniform( 0 );

	const layer = Fn( () => {

		If( distance.greaterThanEqual( solid.x ), () => Discard() );
		If( behind.greaterThan( 0.5 ).and( distance.lessThanEqual( previous.x ) ), () => Discard() );

		return output;

	} )();

	const far = 1e30;
	const node = mrt( { layer, distance: vec4( distance ) } ).setClearColor( 'layer', 0, 0 );
	const opaqueNode = mrt( { layer: output, distance: vec4( distance ) } );

	for ( const n of [ node, opaqueNode ] ) n.setClearColor( 'distance', 0, 1 ).getClearColor( 'distance' ).setRGB( far, far, far );

	const background = new THREE.Color( scene.background ?? 0 );

	opaqueNode.setClearColor( 'layer', background, 1 );

	const kept = { background: scene.background, fn: renderer.getRenderObjectFunction() };

	scene.background = null;
	renderer.transparent = false;
	renderer.setRenderTarget( opaque );
	renderer.setMRT( opaqueNode );
	renderer.render( scene, camera );

	const below = await read( renderer, opaque );

	renderer.transparent = true;
	renderer.opaque = false;
	renderer.setMRT( node );
	renderer.setRenderObjectFunction( ( object, s, c, geometry, material, ...rest ) => {

		const { depthWrite } = material;

		material.depthWrite = true;
		renderer.renderObject( object, s, c, geometry, material, ...rest );
		material.depthWrite = depthWrite;

	} );

	const image = new Float64Array( below.length );
	const through = new Float64Array( below.length / 4 ).fill( 1 );
	let layers = 0;

	for ( ;; layers ++ ) {

		if ( layers === mostLayers ) throw new Error( `More than ${ mostLayers } layers.` );

		const [ target, last ] = layers % 2 === 0 ? targets : [ targets[ 1 ], targets[ 0 ] ];

		behind.value = layers === 0 ? 0 : 1;
		previous.value = last.textures[ 1 ];
		renderer.setRenderTarget( target );
		renderer.render( scene, camera );

		const colors = await read( renderer, target );
		const distances = await read( renderer, target, 1 );
		let found = 0;

		for ( let i = 0; i < through.length; i ++ ) {

			if ( distances[ 4 * i ] > far / 2 ) continue;

			found ++;

			const alpha = Math.min( Math.max( colors[ 4 * i + 3 ], 0 ), 1 );

			for ( let k = 0; k < 3; k ++ ) image[ 4 * i + k ] += through[ i ] * alpha * colors[ 4 * i + k ];

			through[ i ] *= 1 - alpha;

		}

		if ( found === 0 ) break;

	}

	for ( let i = 0; i < through.length; i ++ ) {

		for ( let k = 0; k < 3; k ++ ) image[ 4 * i + k ] += through[ i ] * below[ 4 * i + k ];

		image[ 4 * i + 3 ] = 1 - through[ i ] * ( 1 - below[ 4 * i + 3 ] );

	}

	renderer.setRenderObjectFunction( kept.fn );
	renderer.setMRT( null );
	renderer.setRenderTarget( null );
	renderer.opaque = true;
	scene.background = kept.background;

	for ( const target of [ opaque, ...targets ] ) target.dispose();

	return { image, layers };

}

/** A linear value as a display shows it, 0 … 255, not rounded. */
export const shown = ( linear ) => {

	const v = Math.min( Math.max( linear, 0 ), 1 );

	return 255 * ( v <= 0.0031308 ? 12.92 * v : 1.055 * v ** ( 1 / 2.4 ) - 0.055 );

};

/** The root of the mean squared error, and the largest error, of shown values. */
export function errors( image, exact ) {

	let sum = 0;
	let largest = 0;
	let count = 0;

	for ( let i = 0; i < exact.length; i ++ ) {

		if ( i % 4 === 3 ) continue;

		const error = Math.abs( shown( image[ i ] ) - shown( exact[ i ] ) );

		// A NaN must not vanish in a maximum.
		if ( Number.isNaN( error ) ) return { rmse: NaN, largest: NaN };

		sum += error * error;
		largest = Math.max( largest, error );
		count ++;

	}

	return { rmse: Math.sqrt( sum / count ), largest };

}

/** The mean time of a frame in milliseconds, with the device idle before and after. */
export async function frameTime( renderer, draw, frames ) {

	const done = async () => {

		if ( renderer.backend.isWebGPUBackend === true ) return renderer.backend.device.queue.onSubmittedWorkDone();

		// A read-back waits for all that was drawn before it.
		renderer.backend.gl.readPixels( 0, 0, 1, 1, 0x1908, 0x1401, new Uint8Array( 4 ) );

	};

	draw();
	await done();

	const start = performance.now();

	for ( let i = 0; i < frames; i ++ ) {

		nextFrame( renderer );
		draw();
		await done();

	}

	return ( performance.now() - start ) / frames;

}
