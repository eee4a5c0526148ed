// Builds the examples as static files: `node scripts/example.mjs [folder]`, by default example/dist. The splats are a page of its own, in splats/.

import { copyFileSync, mkdirSync } from 'node:fs';
import { dirname, join, resolve } from 'node:path';
import { fileURLToPath } from 'node:url';
import { build } from 'esbuild';

const PACKAGE = dirname( dirname( fileURLToPath( import.meta.url ) ) );
const folder = resolve( process.argv[ 2 ] ?? join( PACKAGE, 'example/dist' ) );

await import( './models.mjs' );

for ( const page of [ '', 'splats' ] ) {

	const from = join( PACKAGE, 'example', page );
	const to = join( folder, page );

	mkdirSync( to, { recursive: true } );
	copyFileSync( join( from, 'index.html' ), join( to, 'index.html' ) );
	await build( { entryPoints: [ join( from, 'main.js' ) ], outfile: join( to, 'main.js' ), bundle: true, minify: true, format: 'esm', target: 'es2022', logLevel: 'warning' } );
	console.log( `Open ${ join( to, 'index.html' ) } through a web server.` );

}
