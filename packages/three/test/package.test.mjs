// What `npm pack` makes, as a project that installs it sees it.

import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import { cpSync, mkdirSync, mkdtempSync, readFileSync, readdirSync, rmSync, symlinkSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { gzipSync } from 'node:zlib';
import { build } from 'esbuild';
import { PACKAGE } from './browser.mjs';

// What the issue allows, without three.js.
const MOST_BYTES = 60_000;
const MOST_MODEL_BYTES = 10_000;
// A check of a model needs nothing of three.js or of the pass.
const MOST_CHECK_BYTES = 2_000;

const project = mkdtempSync( join( tmpdir(), 'peelnet-three-' ) );
const installed = join( project, 'node_modules/@peelnet/three' );

before( () => {

	const { status, stdout, stderr } = spawnSync( 'npm', [ 'pack', '--pack-destination', project ], { cwd: PACKAGE, encoding: 'utf8', shell: process.platform === 'win32' } );

	assert.equal( status, 0, stderr );

	const tarball = stdout.trim().split( '\n' ).at( - 1 );

	mkdirSync( installed, { recursive: true } );
	assert.equal( spawnSync( 'tar', [ '-xzf', tarball, '-C', installed, '--strip-components=1' ], { cwd: project } ).status, 0 );
	symlinkSync( join( PACKAGE, 'node_modules/three' ), join( project, 'node_modules/three' ), 'junction' );

} );

after( () => rmSync( project, { recursive: true } ) );

async function bundled( code, external = [ 'three' ] ) {

	writeFileSync( join( project, 'main.js' ), code );

	const { outputFiles: [ { contents } ] } = await build( { entryPoints: [ join( project, 'main.js' ) ], bundle: true, minify: true, format: 'esm', write: false, external, logLevel: 'silent' } );

	return contents;

}

test( 'the tarball holds the package and nothing else', () => {

	assert.deepEqual( readdirSync( installed ).sort(), [ 'LICENSE-APACHE', 'LICENSE-MIT', 'README.md', 'models', 'package.json', 'src' ] );
	assert.deepEqual( readdirSync( join( installed, 'models' ) ).filter( ( name ) => name.endsWith( '.js' ) ).sort(), [ 'anchored-medium.js', 'anchored-small.js', 'large.js', 'medium.js', 'one.js', 'small.js' ] );

} );

test( 'the code and the models are as small as promised', async () => {

	const code = gzipSync( await bundled( 'export * from "@peelnet/three";' ), { level: 9 } ).length;

	console.log( `code: ${ code } bytes gzipped` );
	assert.ok( code <= MOST_BYTES );

	for ( const name of readdirSync( join( installed, 'models' ) ).filter( ( file ) => file.endsWith( '.js' ) ) ) {

		const bytes = gzipSync( readFileSync( join( installed, 'models', name ) ), { level: 9 } ).length;

		console.log( `${ name }: ${ bytes } bytes gzipped` );
		assert.ok( bytes <= MOST_MODEL_BYTES, name );

	}

} );

test( 'what is not used is left out', async () => {

	const check = await bundled( 'import { modelProblem } from "@peelnet/three"; console.log( modelProblem( {} ) );', [] );

	assert.ok( gzipSync( check ).length <= MOST_CHECK_BYTES, `${ gzipSync( check ).length } bytes` );

	const none = await bundled( 'import "@peelnet/three"; import "@peelnet/three/models/medium";', [] );

	assert.equal( Buffer.from( none ).toString().trim(), '' );

} );

test( 'the README\'s program builds', async () => {

	const [ , program ] = readFileSync( join( installed, 'README.md' ), 'utf8' ).match( /```js\n([^]*?)```/ );

	assert.ok( program.trim().split( '\n' ).length <= 10, 'more than ten lines' );
	assert.ok( ( await bundled( program, [] ) ).length > 0 );

} );

test( 'the package\'s types are found in a project', () => {

	cpSync( join( PACKAGE, 'test/types/usage.ts' ), join( project, 'usage.ts' ) );
	cpSync( join( PACKAGE, 'test/types/tsconfig.json' ), join( project, 'tsconfig.json' ) );
	mkdirSync( join( project, 'node_modules/@types' ), { recursive: true } );
	symlinkSync( join( PACKAGE, 'node_modules/@types/three' ), join( project, 'node_modules/@types/three' ), 'junction' );

	const { status, stdout } = spawnSync( process.execPath, [ join( PACKAGE, 'node_modules/typescript/bin/tsc' ), '--project', project ], { encoding: 'utf8' } );

	assert.equal( status, 0, stdout );

} );
