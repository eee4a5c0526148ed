// Makes the modules `models/<name>.js` from the exported texts in the repository's `models/<name>/`.
//
//     node scripts/models.mjs
//
// Each holds a description and the texts for WebGPU and WebGL 2 (model.json, model.wgsl, model.es.glsl).

import { mkdirSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { dirname, join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { gzipSync } from 'node:zlib';
import { modelProblem } from '../src/model.js';

const PACKAGE = dirname( dirname( fileURLToPath( import.meta.url ) ) );
const EXPORTS = join( PACKAGE, '../../models' );
const MOST_BYTES = 10_000;

const NAMES = [ 'small', 'medium', 'large', 'anchored-small', 'anchored-medium', 'one' ];

// Comments cost bytes in every page; the licence's line stays.
const withoutComments = ( text ) => text.split( '\n' ).filter( ( line ) => /^\s*(\/\/|$)/.test( line ) === false ).map( ( line ) => line.replace( /^ +/, '' ) ).join( '\n' );

// What an earlier list left behind must not be packed.
rmSync( join( PACKAGE, 'models' ), { recursive: true, force: true } );
mkdirSync( join( PACKAGE, 'models' ) );

for ( const name of NAMES ) {

	const read = ( end ) => readFileSync( join( EXPORTS, name, `model.${ end }` ), 'utf8' );
	const description = JSON.parse( read( 'json' ) );
	const wgsl = withoutComments( read( 'wgsl' ) );
	const glsl = withoutComments( read( 'es.glsl' ) );
	const problem = modelProblem( { description, wgsl, glsl } );

	if ( problem !== null ) throw new Error( `${ name }: ${ problem }` );

	const { format, format_version, tool_version, recipe, parameters, topology, around, passes, resolve, resolve_reads } = description;
	const kept = { format, format_version, tool_version, recipe, parameters, topology, around, passes, resolve, resolve_reads };
	const module = `// A peelnet model for @peelnet/three, made by scripts/models.mjs. Licence: MIT OR Apache-2.0.\n`
		+ `export const description = ${ JSON.stringify( kept ) };\nexport const wgsl = ${ JSON.stringify( wgsl ) };\nexport const glsl = ${ JSON.stringify( glsl ) };\n`
		+ 'export default { description, wgsl, glsl };\n';
	const bytes = gzipSync( module, { level: 9 } ).length;

	writeFileSync( join( PACKAGE, 'models', `${ name }.js` ), module );
	writeFileSync( join( PACKAGE, 'models', `${ name }.d.ts` ), `import type { PeelnetModel } from '../src/index.js';\n\ndeclare const model: PeelnetModel;\nexport default model;\nexport const description: PeelnetModel['description'];\nexport const wgsl: string;\nexport const glsl: string;\n` );
	console.log( `models/${ name }.js: ${ bytes } bytes gzipped` );

	if ( bytes > MOST_BYTES ) throw new Error( `${ name } is larger than ${ MOST_BYTES } bytes.` );

}
