// Builds the example as static files: `node scripts/example.mjs [folder]`, by default example/dist.

import { copyFileSync, mkdirSync } from 'node:fs';
import { dirname, join, resolve } from 'node:path';
import { fileURLToPath } from 'node:url';
import { build } from 'esbuild';

const PACKAGE = dirname( dirname( fileURLToPath( import.meta.url ) ) );
const folder = resolve( process.argv[ 2 ] ?? join( PACKAGE, 'example/dist' ) );

await import( './models.mjs' );
mkdirSync( folder, { recursive: true } );
copyFileSync( join( PACKAGE, 'example/index.html' ), join( folder, 'index.html' ) );
await build( { entryPoints: [ join( PACKAGE, 'example/main.js' ) ], outfile: join( folder, 'main.js' ), bundle: true, minify: true, format: 'esm', target: 'es2022', logLevel: 'warning' } );
console.log( `Open ${ join( folder, 'index.html' ) } through a web server.` );
