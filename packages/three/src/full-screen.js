// Materials and drawings that fill a target.

import { BlendMode, CustomBlending, NoBlending, NodeMaterial, OneFactor, OneMinusSrcAlphaFactor, OneMinusSrcColorFactor, QuadMesh, ZeroFactor } from 'three/webgpu';
import { mrt, vec4 } from 'three/tsl';

const factors = ( source, destination ) => ( { blending: CustomBlending, blendSrc: source, blendDst: destination, blendSrcAlpha: source, blendDstAlpha: destination } );
const mode = ( blending ) => Object.assign( new BlendMode(), blending );

/** Colours that are multiplied by their coverage, over what lies below. */
export const OVER = /*@__PURE__*/ factors( OneFactor, OneMinusSrcAlphaFactor );
export const ADD = /*@__PURE__*/ factors( OneFactor, OneFactor );
/** Coverages, of which both let through what they leave: 1 − (1 − a)(1 − b). */
export const TOGETHER = { ...ADD, blendDst: OneMinusSrcColorFactor };
/** Leaves a target as it is. */
export const KEEP = /*@__PURE__*/ mode( factors( ZeroFactor, OneFactor ) );

/** A quad that fills a target. */
export function fullScreen( name, properties ) {

	const material = new NodeMaterial();

	Object.assign( material, { name: `peelnet ${ name }`, blending: NoBlending, depthTest: false, depthWrite: false, fog: false }, properties );

	return new QuadMesh( material );

}

/** Draws an image over a target of one output, or of these, of which the others stay. */
export function over( image, outputs, blending = OVER ) {

	const transparent = blending.blending !== NoBlending;

	if ( outputs === null ) return { quad: fullScreen( 'image', { fragmentNode: image, transparent, ...blending } ) };

	const names = Object.keys( outputs.outputNodes );
	const node = mrt( Object.fromEntries( names.map( ( name ) => [ name, name === 'output' ? image : vec4( 0 ) ] ) ) );

	for ( const name of names ) node.setBlendMode( name, name === 'output' ? mode( blending ) : KEEP );

	return { quad: fullScreen( 'image', { outputNode: image, transparent, ...blending } ), node };

}

/** Draws a quad between passes, whose settings it leaves. It fills its target or blends over it, so nothing is cleared. */
export function drawQuad( renderer, { target, quad, node = null } ) {

	const { autoClear, opaque } = renderer;
	const draw = renderer.getRenderObjectFunction();

	renderer.setRenderObjectFunction( null );
	renderer.setMRT( node );
	renderer.setRenderTarget( target );
	renderer.autoClear = false;
	renderer.opaque = true;
	quad.render( renderer );
	renderer.autoClear = autoClear;
	renderer.opaque = opaque;
	renderer.setRenderObjectFunction( draw );

}
