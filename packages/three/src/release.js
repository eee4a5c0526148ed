// three.js keeps what it built for an object in a pass (programs, bindings) until the object's material is disposed, and has
// no call that ends a pass before that. Without this, every model that is swapped in would stay in memory. The fields are
// private ones of three.js: where a version lacks them, nothing happens, and the material's dispose frees as before.

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
