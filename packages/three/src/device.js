// What a model needs of the renderer's device, asked before anything is drawn with it.

import { FORMATS, passesOf } from './model.js';

// Bytes are counted as WebGPU counts them against maxColorAttachmentBytesPerSample.
const bytesOf = ( pass ) => pass.targets.reduce( ( sum, target ) => sum + FORMATS[ target.format ].bytes, 0 );

const blendOf = ( target ) => `${ target.color } ${ target.alpha }`;

/**
 * The passes as a device draws them: on WebGL 2 without OES_draw_buffers_indexed in parts, one for each blend.
 *
 * @param {import('three/webgpu').Renderer} renderer
 * @param {object} model
 * @param {'pixel' | 'frame'} range
 * @returns {object[]}
 */
export function drawnPasses( { backend }, model, range ) {

	const passes = passesOf( model.description, range );

	if ( backend.isWebGPUBackend === true || backend.drawBuffersIndexedExt ) return passes;

	return passes.flatMap( ( pass ) => {

		const blends = [ ...new Set( pass.targets.map( blendOf ) ) ];

		return blends.map( ( blend ) => ( { ...pass, targets: pass.targets.filter( ( target ) => blendOf( target ) === blend ) } ) );

	} );

}

/**
 * What a device lacks for a model, as one sentence, or null where nothing is.
 *
 * @param {import('three/webgpu').Renderer} renderer
 * @param {object} model
 * @param {'pixel' | 'frame'} range
 * @returns {string | null}
 */
export function deviceProblem( renderer, model, range ) {

	const passes = drawnPasses( renderer, model, range );
	const targets = passes.flatMap( ( pass ) => pass.targets );
	const count = Math.max( ...passes.map( ( pass ) => pass.targets.length ) );
	const lacks = ( what ) => `This device cannot draw the model "${ model.description.recipe }": ${ what }.`;

	return renderer.backend.isWebGPUBackend === true ? webgpuProblem( renderer, passes, targets, count, lacks ) : webglProblem( renderer, model, targets, count, lacks );

}

function webgpuProblem( { backend }, passes, targets, count, lacks ) {

	const { limits, features } = backend.device;
	const bytes = Math.max( ...passes.map( bytesOf ) );

	if ( backend.compatibilityMode === true ) return lacks( 'three.js blends no targets in WebGPU\'s compatibility mode' );

	if ( limits.maxColorAttachments < count ) return lacks( `it needs ${ count } colour targets and has ${ limits.maxColorAttachments }` );

	if ( limits.maxColorAttachmentBytesPerSample < bytes ) return lacks( `it needs ${ bytes } bytes a sample in one pass and has ${ limits.maxColorAttachmentBytesPerSample }` );

	if ( targets.some( ( target ) => target.format.endsWith( '32float' ) ) && features.has( 'float32-blendable' ) === false ) return lacks( 'it needs the feature float32-blendable' );

	return null;

}

function webglProblem( { backend }, model, targets, count, lacks ) {

	const { gl, extensions } = backend;

	if ( typeof model.glsl !== 'string' || model.glsl.includes( 'peelnet_resolve(' ) === false ) return `The model "${ model.description.recipe }" has no GLSL text, which WebGL 2 needs.`;

	if ( ! extensions.get( 'EXT_color_buffer_float' ) && ! extensions.get( 'EXT_color_buffer_half_float' ) ) return lacks( 'WebGL 2 needs the extension EXT_color_buffer_float or EXT_color_buffer_half_float' );

	if ( targets.some( ( target ) => target.format.endsWith( '32float' ) ) && ! extensions.get( 'EXT_float_blend' ) ) return lacks( 'WebGL 2 needs the extension EXT_float_blend' );

	const most = gl.getParameter( gl.MAX_DRAW_BUFFERS );

	return most < count ? lacks( `it needs ${ count } colour targets and has ${ most }` ) : null;

}

// Who wants to know of a renderer's lost device. The renderer holds nobody who no longer wants to.
const listeners = /*@__PURE__*/ new WeakMap();

/**
 * Calls back when the renderer's device is lost. A renderer that is disposed loses nothing.
 *
 * @returns {() => void} stops watching
 */
export function watchDevice( renderer, onLost ) {

	let all = listeners.get( renderer );

	if ( all === undefined ) {

		const before = renderer.onDeviceLost;

		all = new Set();
		listeners.set( renderer, all );
		renderer.onDeviceLost = ( info ) => {

			before.call( renderer, info );
			all.forEach( ( listener ) => listener( 'The graphics device was lost. Nothing can be drawn until a new renderer and a new peelnetPass are made.' ) );

		};

	}

	all.add( onLost );

	return () => all.delete( onLost );

}
