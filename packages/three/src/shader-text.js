// The functions that stand between three.js and a model's text: one per pass, and one that resolves. They are written from
// the model's description, in the language of the back end.

import { FORMATS, texturesByName } from './model.js';

const WGSL_TYPES = { float: 'f32', vec2: 'vec2f', vec3: 'vec3f', vec4: 'vec4f', mat4: 'mat4x4f' };

const WGSL = {
	type: ( type ) => WGSL_TYPES[ type ],
	function: ( name, parameters, result, body ) => `fn ${ name }(${ parameters.map( ( [ n, t ] ) => `${ n }: ${ WGSL_TYPES[ t ] }` ).join( ', ' ) }) -> ${ WGSL_TYPES[ result ] } {\n${ body }\n}`,
	constant: ( type, name, value ) => `let ${ name } = ${ value };`,
	expression: ( text ) => text,
	statements: ( text ) => text
};

const GLSL = {
	type: ( type ) => type,
	function: ( name, parameters, result, body ) => `${ result } ${ name }(${ parameters.map( ( [ n, t ] ) => `${ t } ${ n }` ).join( ', ' ) }) {\n${ body }\n}`,
	constant: ( type, name, value ) => `${ type } ${ name } = ${ value };`,
	expression: ( text ) => text.replace( /\bvec([234])f\b/g, 'vec$1' ).replace( /\bmat4x4f\b/g, 'mat4' ).replace( /\bvec2u\b/g, 'uvec2' ),
	// WGSL's `let` has no type; GLSL needs one.
	statements: ( text, library ) => GLSL.expression( text ).replace( /\blet (\w+) = ([^;]+);/g, ( _, name, value ) => `${ typeOf( value, library ) } ${ name } = ${ value };` )
};

// The type of a value that a description computes: what an exported function returns, or a channel of it.
function typeOf( value, library ) {

	const call = value.match( /^(peelnet_\w+)\(.*\)$/ );

	return call === null ? 'float' : library.match( new RegExp( `(\\w+) ${ call[ 1 ] }\\(` ) )?.[ 1 ] ?? 'float';

}

const CHANNELS = { 1: 'r', 2: 'rg', 4: 'rgba' };
const VECTORS = { 1: 'float', 2: 'vec2', 4: 'vec4' };

function widened( language, expression, channels ) {

	return channels === 4 ? expression : language.expression( `vec4f(${ expression }${ ', 0.0'.repeat( 4 - channels ) })` );

}

/** The text that a back end compiles. */
export const libraryText = ( model, isGlsl ) => isGlsl ? model.glsl : model.wgsl;

// What was read as four channels, as the names and types of the description. A target that was not drawn is the bins of a pixel
// without fragments: then slabs are cut by the frame's depth.
function reads( language, model, names, drawn ) {

	const textures = texturesByName( model.description );

	return names.map( ( name ) => {

		const { format, otherwise } = textures.get( name );
		const { channels } = FORMATS[ format ];
		const type = VECTORS[ channels ];
		const value = drawn.has( name ) ? `read_${ name }.${ CHANNELS[ channels ] }` : otherwise ?? `${ language.type( type ) }(0.0)`;

		return '\t' + language.constant( type, name, value );

	} );

}

const parameters = ( names, drawn ) => names.filter( ( name ) => drawn.has( name ) ).map( ( name ) => [ `read_${ name }`, 'vec4' ] );

// The noise of a pixel, where a model has some.
const noise = ( language, model, isGlsl ) => libraryText( model, isGlsl ).includes( 'peelnet_noise(' ) ? [ '\t' + language.constant( 'float', 'noise', language.expression( 'peelnet_noise(vec2u(pixel))' ) ) ] : [];

/**
 * A pass as a function of the fragment. It returns a matrix, whose columns are what four targets from the `first` on are written.
 *
 * `color` is the fragment's colour with opacity in alpha, `distance_view` its distance along the view axis, `span` what to
 * subtract from that and then the frame's PeelnetRange: one logarithm less for each fragment than near and far.
 */
export function passText( model, pass, first, drawn, isGlsl ) {

	const language = isGlsl ? GLSL : WGSL;
	const library = libraryText( model, isGlsl );
	const columns = pass.targets.slice( first, first + 4 ).map( ( target ) => widened( language, language.expression( target.write ), FORMATS[ target.format ].channels ) );

	while ( columns.length < 4 ) columns.push( `${ language.type( 'vec4' ) }(0.0)` );

	return language.function( `peelnet_pass_${ pass.name }_${ first }`, [ [ 'color', 'vec4' ], [ 'distance_view', 'float' ], [ 'span', 'vec4' ], [ 'pixel', 'vec2' ], ...parameters( pass.reads, drawn ) ], 'mat4', [
		'\t' + language.constant( 'float', 'alpha', 'clamp(color.a, 0.0, 1.0)' ),
		'\t' + language.constant( 'vec3', 'rgb', 'color.rgb' ),
		'\t' + language.constant( 'float', 'z', 'distance_view - span.x' ),
		'\t' + language.constant( 'float', 'zeta', 'peelnet_zeta_in(z, PeelnetRange(span.y, span.z, span.w))' ),
		...reads( language, model, pass.reads, drawn ),
		...noise( language, model, isGlsl ),
		'\t' + language.statements( pass.compute, library ),
		`\treturn ${ language.type( 'mat4' ) }(${ columns.join( ', ' ) });`
	].join( '\n' ) );

}

/** The resolve as one function of what it reads: colour times coverage, and coverage in alpha. */
export function resolveText( model, drawn, isGlsl ) {

	const language = isGlsl ? GLSL : WGSL;
	const { resolve, resolve_reads: names } = model.description;

	return language.function( 'peelnet_pass_resolve', [ [ 'pixel', 'vec2' ], ...parameters( names, drawn ) ], 'vec4', [
		'\t' + language.constant( 'vec3', 'background', `${ language.type( 'vec3' ) }(0.0)` ),
		...reads( language, model, names, drawn ),
		...noise( language, model, isGlsl ),
		`\treturn ${ language.expression( resolve ) };`
	].join( '\n' ) );

}

/**
 * What a texel adds to the sum that the small texture is made of, as a function of that sum and of what is read there: one of the description's
 * expressions `sum`, of the small pass, and `last`, of the last frame. `names` are those of what it reads.
 */
export function sumText( model, key, names, isGlsl ) {

	const language = isGlsl ? GLSL : WGSL;
	const drawn = new Set( names );

	return language.function( `peelnet_around_${ key }`, [ [ 'sum', 'mat4' ], [ 'pixel', 'vec2' ], ...parameters( names, drawn ) ], 'mat4', [
		...reads( language, model, names, drawn ),
		...noise( language, model, isGlsl ),
		`\treturn sum + ${ language.expression( model.description.around[ key ] ) };`
	].join( '\n' ) );

}

/** A texel of the small texture, as a function of the sum. */
export function aroundText( model, isGlsl ) {

	const language = isGlsl ? GLSL : WGSL;

	return language.function( 'peelnet_around', [ [ 'sum', 'mat4' ] ], 'vec4', `\treturn ${ language.expression( model.description.around.write ) };` );

}
