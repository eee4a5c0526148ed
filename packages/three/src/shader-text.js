// The functions that stand between three.js and a model's text: one per pass, and one that resolves. They are written from
// the model's description, in the language of the back end.

import { FORMATS, targetsByName } from './model.js';

const WGSL = {
	vec3: 'vec3f',
	matrix: 'mat4x4f',
	zero: 'vec4f(0.0)',
	function: ( name, parameters, result, body ) => `fn ${ name }(${ parameters.map( ( [ n, t ] ) => `${ n }: ${ t === 'float' ? 'f32' : `${ t }f` }` ).join( ', ' ) }) -> ${ result } {\n${ body }\n}`,
	constant: ( type, name, value ) => `let ${ name } = ${ value };`,
	expression: ( text ) => text,
	statements: ( text ) => text
};

const GLSL = {
	vec3: 'vec3',
	matrix: 'mat4',
	zero: 'vec4(0.0)',
	function: ( name, parameters, result, body ) => `${ result.replace( /f$/, '' ) } ${ name }(${ parameters.map( ( [ n, t ] ) => `${ t } ${ n }` ).join( ', ' ) }) {\n${ body }\n}`,
	constant: ( type, name, value ) => `${ type } ${ name } = ${ value };`,
	expression: ( text ) => text.replace( /\bvec([234])f\b/g, 'vec$1' ),
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

	const targets = targetsByName( model.description );

	return names.map( ( name ) => {

		const { channels } = FORMATS[ targets.get( name ).format ];
		const value = drawn.has( name ) ? `read_${ name }.${ CHANNELS[ channels ] }` : language.expression( `${ VECTORS[ channels ] }f(0.0)` );

		return '\t' + language.constant( VECTORS[ channels ], name, value );

	} );

}

const parameters = ( names, drawn ) => names.filter( ( name ) => drawn.has( name ) ).map( ( name ) => [ `read_${ name }`, 'vec4' ] );

/**
 * A pass as one function of the fragment. It returns a matrix: a column per target.
 *
 * `color` is the fragment's colour with opacity in alpha, `distance_view` its distance along the view axis, `span` what to
 * subtract from that and then the frame's PeelnetRange: one logarithm less for each fragment than near and far.
 */
export function passText( model, pass, drawn, isGlsl ) {

	const language = isGlsl ? GLSL : WGSL;
	const library = libraryText( model, isGlsl );
	const columns = pass.targets.map( ( target ) => widened( language, language.expression( target.write ), FORMATS[ target.format ].channels ) );

	while ( columns.length < 4 ) columns.push( language.zero );

	return language.function( `peelnet_pass_${ pass.name }`, [ [ 'color', 'vec4' ], [ 'distance_view', 'float' ], [ 'span', 'vec4' ], ...parameters( pass.reads, drawn ) ], language.matrix, [
		'\t' + language.constant( 'float', 'alpha', 'clamp(color.a, 0.0, 1.0)' ),
		'\t' + language.constant( 'vec3', 'rgb', 'color.rgb' ),
		'\t' + language.constant( 'float', 'z', 'distance_view - span.x' ),
		'\t' + language.constant( 'float', 'zeta', 'peelnet_zeta_in(z, PeelnetRange(span.y, span.z, span.w))' ),
		...reads( language, model, pass.reads, drawn ),
		'\t' + language.statements( pass.compute, library ),
		`\treturn ${ language.matrix }(${ columns.join( ', ' ) });`
	].join( '\n' ) );

}

/** The resolve as one function of the opaque image and of what it reads: colour, and coverage in alpha. */
export function resolveText( model, isGlsl ) {

	const language = isGlsl ? GLSL : WGSL;
	const { resolve, resolve_reads: names } = model.description;
	const drawn = new Set( names );

	return language.function( 'peelnet_pass_resolve', [ [ 'below', 'vec4' ], ...parameters( names, drawn ) ], isGlsl ? 'vec4' : 'vec4f', [
		'\t' + language.constant( 'vec3', 'background', 'below.rgb' ),
		...reads( language, model, names, drawn ),
		'\t' + language.constant( 'vec4', 'resolved', language.expression( resolve ) ),
		`\treturn ${ isGlsl ? 'vec4' : 'vec4f' }(resolved.rgb, resolved.a + below.a * (1.0 - resolved.a));`
	].join( '\n' ) );

}
