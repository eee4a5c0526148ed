// Makes the modules `models/<name>.js` from the exported texts in the repository's `models/<name>/`.
//
//     node scripts/models.mjs [name ...]
//
// Reads model.wgsl, model.json and model.es.glsl. Where an export does not hold the last two yet, the description is read
// from the text's header, and the GLSL is translated by `naga` (PEELNET_NAGA, or on the path); without it, it is left out.

import { spawnSync } from 'node:child_process';
import { existsSync, mkdirSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { dirname, join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { gzipSync } from 'node:zlib';
import { modelProblem } from '../src/model.js';
import { descriptionOf } from './header.mjs';

const PACKAGE = dirname( dirname( fileURLToPath( import.meta.url ) ) );
const EXPORTS = join( PACKAGE, '../../models' );
const MOST_BYTES = 10_000;

const isMain = process.argv[ 1 ] === fileURLToPath( import.meta.url );
const names = isMain && process.argv.length > 2 ? process.argv.slice( 2 ) : [ 'small', 'medium', 'large', 'anchored-small', 'anchored-medium' ];

// Comments cost bytes in every page; the licence's line stays.
const withoutComments = ( text ) => text.split( '\n' ).filter( ( line ) => /^\s*(\/\/|$)/.test( line ) === false ).map( ( line ) => line.replace( /^ +/, '' ) ).join( '\n' );

// What three.js writes itself.
const withoutPreamble = ( text ) => text.replace( /^(#version|precision|smooth in|layout\(location).*\n/gm, '' );

mkdirSync( join( PACKAGE, 'models' ), { recursive: true } );

for ( const name of names ) {

	const file = ( end ) => join( EXPORTS, name, `model.${ end }` );
	const text = readFileSync( file( 'wgsl' ), 'utf8' );
	const description = existsSync( file( 'json' ) ) ? JSON.parse( readFileSync( file( 'json' ), 'utf8' ) ) : descriptionOf( text );
	const wgsl = withoutComments( text );
	const glslText = existsSync( file( 'es.glsl' ) ) ? readFileSync( file( 'es.glsl' ), 'utf8' ) : translated( wgsl );
	const glsl = glslText === null ? null : withoutComments( withoutPreamble( glslText ) );

	const problem = modelProblem( { description, wgsl, glsl } );

	if ( problem !== null ) throw new Error( `${ name }: ${ problem }` );

	const { format, format_version, tool_version, recipe, parameters, topology, passes, resolve, resolve_reads } = description;
	const kept = { format, format_version, tool_version, recipe, parameters, topology, passes, resolve, resolve_reads };
	const module = `// A peelnet model for @peelnet/three, made by scripts/models.mjs. Licence: MIT OR Apache-2.0.\n`
		+ `export const description = ${ JSON.stringify( kept ) };\nexport const wgsl = ${ JSON.stringify( wgsl ) };\nexport const glsl = ${ JSON.stringify( glsl ) };\n`
		+ 'export default { description, wgsl, glsl };\n';
	const bytes = gzipSync( module, { level: 9 } ).length;

	writeFileSync( join( PACKAGE, 'models', `${ name }.js` ), module );
	writeFileSync( join( PACKAGE, 'models', `${ name }.d.ts` ), `import type { PeelnetModel } from '../src/index.js';\n\ndeclare const model: PeelnetModel;\nexport default model;\nexport const description: PeelnetModel['description'];\nexport const wgsl: string;\nexport const glsl: string | null;\n` );
	console.log( `models/${ name }.js: ${ bytes } bytes gzipped${ glsl === null ? ', without GLSL (no naga)' : '' }` );

	if ( bytes > MOST_BYTES ) throw new Error( `${ name } is larger than ${ MOST_BYTES } bytes.` );

}

// The functions that a renderer calls, in GLSL ES 3.00. naga keeps only what an entry point reaches, so one calls them all.
function translated( wgsl ) {

	const folder = mkdtempSync( join( tmpdir(), 'peelnet-' ) );
	const values = { f32: 'v.x', bool: 'v.x > 0.0', vec2f: 'v.xy', vec3f: 'v.xyz', vec4f: 'v' };
	const calls = [ ...wgsl.matchAll( /^fn (peelnet_(?:zeta|pixel_range|statistics|fragment|resolve))\(([^)]*)\)/gm ) ].map( ( [ , name, parameters ] ) => {

		const types = [ ...parameters.matchAll( /: *(\w+)/g ) ].map( ( [ , type ] ) => values[ type ] );

		return `_ = ${ name }(${ types.join( ', ' ) });`;

	} );

	try {

		writeFileSync( join( folder, 'in.wgsl' ), `${ wgsl }\n@fragment fn peelnet_main(@location(0) v: vec4f) -> @location(0) vec4f { ${ calls.join( ' ' ) } return v; }\n` );

		const { status, error, stderr } = spawnSync( process.env.PEELNET_NAGA ?? 'naga', [ join( folder, 'in.wgsl' ), join( folder, 'out.frag' ), '--profile', 'es300', '--entry-point', 'peelnet_main' ], { encoding: 'utf8' } );

		if ( error !== undefined ) return null;
		if ( status !== 0 ) throw new Error( stderr );

		return readFileSync( join( folder, 'out.frag' ), 'utf8' ).replace( /^void main\(\) \{[^]*$/m, '' );

	} finally {

		rmSync( folder, { recursive: true } );

	}

}
