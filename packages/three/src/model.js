// What a model must be, checked once before anything is built from it.

/** The version of `description` that this package reads. */
export const FORMAT_VERSION = 1;

// Channels and bytes of every format a description may name.
export const FORMATS = {
	r8unorm: { channels: 1, bytes: 1 },
	rg8unorm: { channels: 2, bytes: 2 },
	rgba8unorm: { channels: 4, bytes: 8 },
	r16float: { channels: 1, bytes: 2 },
	rg16float: { channels: 2, bytes: 4 },
	rgba16float: { channels: 4, bytes: 8 },
	r32float: { channels: 1, bytes: 4 },
	rg32float: { channels: 2, bytes: 8 },
	rgba32float: { channels: 4, bytes: 16 }
};

export const BLENDS = [ 'add', 'max', 'transmit' ];

// Names become identifiers of shader text, so nothing else may stand in them.
const NAME = /^[a-z][a-z_]*$/;

const list = ( value ) => Array.isArray( value ) ? value : [];

/**
 * What is wrong with a model, as one sentence, or null where nothing is.
 *
 * @param {unknown} model - `{ description, wgsl, glsl }`
 * @returns {string | null}
 */
export function modelProblem( model ) {

	const description = model?.description;

	if ( description?.format !== 'peelnet-export' ) {

		return 'The model is no peelnet export: pass { description, wgsl, glsl }, for example the default export of "@peelnet/three/models/medium".';

	}

	if ( description.format_version !== FORMAT_VERSION ) {

		return `The model has format version ${ Number( description.format_version ) }, and this package reads version ${ FORMAT_VERSION }: export the model again, or install the package of its version.`;

	}

	const recipe = String( description.recipe );

	if ( typeof model.wgsl !== 'string' || model.wgsl.includes( 'fn peelnet_resolve(' ) === false ) {

		return `The model "${ recipe }" has no WGSL text with peelnet_resolve.`;

	}

	const unsupported = ( what ) => `The recipe "${ recipe }" cannot be drawn by this package: ${ what }. Networks of small, medium, large, one, one-wide, anchored-small and anchored-medium can.`;

	if ( model.wgsl.includes( 'fn peelnet_zeta_in(' ) === false ) return unsupported( 'its text has no peelnet_zeta_in' );

	if ( /^\s*enable\s+f16/m.test( model.wgsl ) ) return `The text of the model "${ recipe }" needs 16-bit numbers, which three.js enables for no text: export it without --precision f16.`;

	const passes = list( description.passes );

	if ( passes.length === 0 ) return unsupported( 'it describes no pass' );

	const { around } = description;
	const known = new Set();

	if ( around !== undefined ) {

		const valid = NAME.test( around?.name ) && FORMATS[ around.format ] !== undefined && around.every >= 1
			&& [ around.pass?.name, around.sum, around.write, around.otherwise ].every( ( text ) => typeof text === 'string' );

		if ( valid === false ) return unsupported( 'what it reads around a pixel is not described' );

		known.add( around.name );

	}

	for ( const pass of around === undefined ? passes : [ around.pass, ...passes ] ) {

		if ( NAME.test( pass.name ) === false || typeof pass.compute !== 'string' ) return unsupported( 'a pass has no valid name or computation' );

		const unknown = list( pass.reads ).find( ( name ) => known.has( name ) === false );

		if ( unknown !== undefined ) return unsupported( `its pass "${ pass.name }" reads "${ unknown }", which no pass before it writes` );

		if ( list( pass.targets ).length === 0 ) return unsupported( `its pass "${ pass.name }" has no targets` );

		for ( const target of pass.targets ) {

			const valid = NAME.test( target.name ) && FORMATS[ target.format ] !== undefined && typeof target.write === 'string'
				&& BLENDS.includes( target.color ) && BLENDS.includes( target.alpha )
				&& list( target.clear ).length === 4 && target.clear.every( Number.isFinite );

			if ( valid === false ) return unsupported( `its target "${ target.name }" has an unknown format, blend or clear value` );

		}

		// A pass may read what passes before it wrote, never its own targets.
		for ( const target of pass.targets ) known.add( target.name );

	}

	if ( typeof description.resolve !== 'string' ) return unsupported( 'it has no resolve' );

	const unknown = list( description.resolve_reads ).find( ( name ) => known.has( name ) === false );

	if ( unknown !== undefined ) return unsupported( `its resolve reads "${ unknown }", which no pass writes` );

	return null;

}

/** Every texture of a description by its name. */
export function texturesByName( { around, passes } ) {

	const small = around === undefined ? [] : [ around, ...around.pass.targets ];

	return new Map( [ ...small, ...passes.flatMap( ( pass ) => pass.targets ) ].map( ( texture ) => [ texture.name, texture ] ) );

}

/** The passes to draw. With `range: 'frame'` the one that finds what is seen around each pixel is left out. */
export function passesOf( { around, passes }, range ) {

	return range === 'frame' || around === undefined ? passes : [ around.pass, ...passes ];

}

/** Whether a pass writes colours, and so needs light. */
export const isShaded = ( pass ) => /\brgb\b/.test( [ pass.compute, ...pass.targets.map( ( target ) => target.write ) ].join( ';' ) );

/**
 * Loads an exported model: `<url>.json`, `<url>.wgsl` and, where there is one, `<url>.es.glsl`, which `peelnet export` writes beside one another.
 *
 * @param {string | URL} url - without an ending, such as `models/model`
 * @returns {Promise<{ description: object, wgsl: string, glsl: string | null }>}
 */
export async function loadModel( url ) {

	const get = async ( ending, isNeeded ) => {

		const response = await fetch( `${ url }.${ ending }` );

		if ( response.ok === false && isNeeded ) throw new Error( `@peelnet/three: ${ url }.${ ending }: ${ response.status } ${ response.statusText }` );

		return response.ok ? response : null;

	};

	const [ description, wgsl, glsl ] = await Promise.all( [ get( 'json', true ), get( 'wgsl', true ), get( 'es.glsl', false ) ] );
	const model = { description: await description.json(), wgsl: await wgsl.text(), glsl: glsl === null ? null : await glsl.text() };
	const problem = modelProblem( model );

	if ( problem !== null ) throw new Error( `@peelnet/three: ${ url }: ${ problem }` );

	return model;

}
