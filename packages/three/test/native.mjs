// The page against the native renderer, same meshes and camera: `npm run native`. It needs the command peelnet, on the path or named by
// PEELNET_BINARY (in the repository: cargo build --release -p peelnet, then target/release/peelnet).

import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { existsSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { PACKAGE, open } from './browser.mjs';

// What the issue asks: one step of 255 in the mean.
const MOST = 1;

const BUILT = join( PACKAGE, '../../target/release/peelnet' );
const PEELNET = process.env.PEELNET_BINARY ?? ( existsSync( BUILT ) ? BUILT : 'peelnet' );
const METHODS = { exact: 'abuffer', small: 'deep-small', medium: 'deep-medium', large: 'deep-large', 'anchored-small': 'deep-anchored-small', one: 'deep-one' };

const browser = await open();
const folder = mkdtempSync( join( tmpdir(), 'peelnet-native-' ) );

try {

	const { glb, camera, background, size } = await browser.run( 'exportedScene', 'webgpu' );
	const scene = join( folder, 'scene.toml' );

	writeFileSync( join( folder, 'scene.glb' ), Buffer.from( glb, 'base64' ) );
	writeFileSync( scene, [
		`background = ${ JSON.stringify( background ) }`, '', '[camera]',
		...Object.entries( camera ).map( ( [ key, value ] ) => `${ key } = ${ JSON.stringify( value ) }` ),
		'', '[[object]]', 'mesh = "scene.glb"', ''
	].join( '\n' ) );

	const images = {};

	for ( const [ name, method ] of Object.entries( METHODS ) ) {

		const png = join( folder, `${ name }.png` );

		execFileSync( PEELNET, [ 'render', scene, '--method', method, '--size', size.join( 'x' ), '--out', png, '--quiet' ], { stdio: [ 'ignore', 'inherit', 'inherit' ] } );
		images[ name ] = readFileSync( png ).toString( 'base64' );

	}

	console.log( execFileSync( PEELNET, [ '--version' ], { encoding: 'utf8' } ).trim(), browser.version );

	for ( const backend of [ 'webgpu', 'webgl2' ] ) {

		const { problems, models, sorted, exact } = await browser.run( 'againstNative', backend, { images } );

		console.log( `${ backend }: RMSE of 255; the exact images are ${ exact.rmse.toFixed( 2 ) } apart, along edges` );
		console.table( { ...models, 'three.js, sorted': sorted } );
		assert.deepEqual( problems, [] );

		for ( const [ name, { apart } ] of Object.entries( models ) ) assert.ok( apart <= MOST, `${ backend }, ${ name }: ${ apart } of 255` );

		// A wrong picture is told from a right one.
		assert.ok( sorted.apart > MOST, `${ backend }: sorted drawing is as good, so the scene tells nothing` );

	}

} finally {

	await browser.close();
	rmSync( folder, { recursive: true } );

}
