// All that this package uses of three.js beyond what three.js documents, a function for each. A test asks for every field by its name, and a
// version of three.js that has one no more fails it.

/** The fields, as paths from a renderer on WebGPU, one on WebGL 2 with OES_draw_buffers_indexed, a drawn pass and a batch. */
export const PRIVATE = {
	webgpu: [ 'backend.beginBundle', '_objects._renderObjects', '_renderContexts._renderContexts' ],
	webgl2: [ 'backend.drawBuffersIndexedExt', '_objects._renderObjects', '_renderContexts._renderContexts' ],
	pass: [ '_previousTextures', '_getContextNode' ],
	batch: [ '_instanceInfo' ]
};

/**
 * Lets WebGL 2 without OES_draw_buffers_indexed blend as the targets of a pass do, which then are all alike.
 *
 * @returns {() => void} ends it
 */
export function blendAlike( { backend } ) {

	const { gl, drawBuffersIndexedExt } = backend;

	if ( backend.isWebGPUBackend === true || drawBuffersIndexedExt ) return () => {};

	backend.drawBuffersIndexedExt = {
		blendEquationSeparateiOES: ( index, ...equations ) => gl.blendEquationSeparate( ...equations ),
		blendFuncSeparateiOES: ( index, ...factors ) => gl.blendFuncSeparate( ...factors )
	};

	return () => ( backend.drawBuffersIndexedExt = drawBuffersIndexedExt );

}

/**
 * Lets a renderer draw the objects of bundles one by one. The field is a method of three.js's WebGPU back end: where there is none, there are no bundles.
 *
 * @returns {() => void} ends it
 */
export function leaveOutBundles( { backend } ) {

	const { beginBundle } = backend;

	if ( beginBundle === undefined ) return () => {};

	backend.beginBundle = undefined;

	return () => ( backend.beginBundle = beginBundle );

}

// three.js keeps what it built for an object in a pass (programs, bindings) until the object's material is disposed, and has no call that ends a
// pass before that. Without this, every model that is swapped in would stay in memory.

/**
 * Frees what a renderer built for MRT nodes that are drawn no more.
 *
 * @param {import('three/webgpu').Renderer} renderer
 * @param {Set<object>} nodes
 */
export function releasePasses( renderer, nodes ) {

	for ( const renderObject of [ ...renderer._objects?._renderObjects ?? [] ] ) {

		if ( nodes.has( renderObject.context?.mrt ) ) renderObject.dispose();

	}

	const contexts = renderer._renderContexts?._renderContexts ?? {};

	for ( const [ key, context ] of Object.entries( contexts ) ) {

		if ( nodes.has( context.mrt ) ) delete contexts[ key ];

	}

}

/**
 * What the scene is drawn with besides its materials, where a pass has a context of its own.
 *
 * @param {import('three/webgpu').PassNode} pass
 */
export const contextOf = ( pass, renderer ) => pass.contextNode === null ? renderer.contextNode : pass._getContextNode( renderer );

/**
 * Draws what is no new frame: what the pass shows of the frame before stays.
 *
 * @param {import('three/webgpu').PassNode} pass
 */
export function drawAgain( pass, draw ) {

	const { _previousTextures } = pass;

	pass._previousTextures = {};
	draw();
	pass._previousTextures = _previousTextures;

}

/**
 * The instances of a batch that are shown, as `[ id, geometryId ]`: those of the numbers between them were deleted, and asking for one is an error.
 *
 * @param {import('three/webgpu').BatchedMesh} mesh
 */
export function* instancesOfBatch( { _instanceInfo } ) {

	for ( let i = 0; i < _instanceInfo.length; i ++ ) {

		const { active, visible, geometryIndex } = _instanceInfo[ i ];

		if ( active && visible ) yield [ i, geometryIndex ];

	}

}
