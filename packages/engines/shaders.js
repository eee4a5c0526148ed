// The WGSL that both engines put around a model's text. Only the declarations of inputs and outputs differ, and stand in the engines' own files.

import { aroundText, passText, resolveText, sumText } from '../three/src/shader-text.js';

/** What shaders call the texture that holds a target of the description. */
export const textureName = ( name ) => `peelnet_target_${ name }`;

// The small texture is read between its texels and so needs a sampler; all others are read at the fragment's own pixel.
const declaration = ( { around }, name ) => `var ${ textureName( name ) }: texture_2d<f32>;` + ( name === around?.name ? `\nvar ${ textureName( name ) }Sampler: sampler;` : '' );
const reading = ( { around }, name ) => name === around?.name
	? `textureSampleLevel(${ textureName( name ) }, ${ textureName( name ) }Sampler, pixel / size, 0.0)`
	: `textureLoad(${ textureName( name ) }, vec2i(pixel), 0)`;

const declarations = ( description, names ) => names.map( ( name ) => declaration( description, name ) ).join( '\n' );

/**
 * A pass over the transparent surfaces. `body` stands in a fragment shader that has set `color` (opacity in alpha), `depth` (the distance
 * along the view axis), `span` (of spanOf), `size` (of the frame in pixels) and `pixel`. `outputs` are then what the targets are written.
 */
export function passShader( model, pass ) {

	const { description } = model;
	const firsts = [ 0, 4 ].filter( ( first ) => first < pass.targets.length );
	const inputs = [ 'color', 'depth', 'span', 'pixel', ...pass.reads.map( ( name ) => reading( description, name ) ) ].join( ', ' );

	return {
		head: [ declarations( description, pass.reads ), model.wgsl, ...firsts.map( ( first ) => passText( model, pass, first, new Set( pass.reads ), false ) ) ].join( '\n' ),
		body: firsts.map( ( first ) => `let columns_${ first } = peelnet_pass_${ pass.name }_${ first }(${ inputs });` ).join( '\n' ),
		outputs: pass.targets.map( ( _, i ) => `columns_${ i - i % 4 }[${ i % 4 }]` )
	};

}

/** What makes the small texture from the targets of the small pass, for a full-screen shader that has set `pixel`. */
export function aroundShader( model ) {

	const { description } = model;
	const names = description.around.pass.targets.map( ( target ) => target.name );
	const texels = names.map( ( name ) => `textureLoad(${ textureName( name ) }, at, 0)` ).join( ', ' );

	return {
		names,
		head: [ declarations( description, names ), model.wgsl, sumText( model, 'sum', names, false ), aroundText( model, false ), `
fn peelnet_texel(pixel: vec2f) -> vec4f {
	let last = vec2i(textureDimensions(${ textureName( names[ 0 ] ) })) - 1;
	var sum = mat4x4f();
	for (var i = 0; i < 9; i++) {
		let at = clamp(vec2i(pixel) + vec2i(i % 3 - 1, i / 3 - 1), vec2i(0), last);
		sum = peelnet_around_sum(sum, vec2f(at), ${ texels });
	}
	return peelnet_around(sum);
}` ].join( '\n' ),
		output: 'peelnet_texel(pixel)'
	};

}

/** The resolve, for a full-screen shader that has set `pixel` and `size`: colour times coverage, to be blended over the opaque image. */
export function resolveShader( model ) {

	const { description } = model;
	const names = description.resolve_reads;

	return {
		names,
		head: [ declarations( description, names ), model.wgsl, resolveText( model, new Set( names ), false ) ].join( '\n' ),
		output: `peelnet_pass_resolve(${ [ 'pixel', ...names.map( ( name ) => reading( description, name ) ) ].join( ', ' ) })`
	};

}

/**
 * The frame's range of depth as the texts take it. The tighter it is, the smaller the error.
 *
 * @param {number[]} depths - distances along the view axis of the corners of the boxes around transparent objects in view
 * @param {number} near - of the camera, as `far`
 * @param {number} far
 * @returns {number[]} what to subtract from a distance, then the fields of PeelnetRange
 */
export function spanOf( depths, near, far ) {

	const first = Math.max( Math.min( ...depths ), near );
	const extent = Math.log( Math.min( Math.max( ...depths ), far ) / first );

	return [ 0, 1 / first, first, extent > 1e-6 ? 2 / extent : 0 ];

}
