// Draws the scene in headless Chromium: `peer scene.json npm-folder`; called by transparency.py. Chromium is found as the tests of packages/three
// find it, but its WebGL is drawn by the system's OpenGL, so that Mesa's llvmpipe draws for all.

import { execFileSync } from 'node:child_process';
import { existsSync, readFileSync, writeFileSync } from 'node:fs';
import { createServer } from 'node:http';
import { createRequire } from 'node:module';
import { dirname, join, resolve } from 'node:path';
import { fileURLToPath } from 'node:url';

const HERE = dirname( fileURLToPath( import.meta.url ) );
const OURS = join( HERE, '../../packages/three' );
const [ , , peer, sceneFile, npm ] = process.argv;
const installed = createRequire( join( resolve( npm ), 'package.json' ) );
const packages = join( resolve( npm ), 'node_modules' );
const folder = dirname( resolve( sceneFile ) );
const scene = JSON.parse( readFileSync( sceneFile, 'utf8' ) );

if ( peer === 'three' ) execFileSync( process.execPath, [ join( OURS, 'scripts/models.mjs' ) ], { stdio: 'ignore' } );

const { outputFiles: [ script ] } = await installed( 'esbuild' ).build( {
	entryPoints: [ join( HERE, 'transparency_page', `${ peer }.js` ) ], bundle: true, write: false, format: 'esm', target: 'es2022', logLevel: 'error', nodePaths: [ packages ],
	// One three.js for all that import it, by any name.
	alias: {
		'three/addons': join( packages, 'three/examples/jsm' ), 'three/tsl': join( packages, 'three/build/three.tsl.js' ),
		'three/webgpu': join( packages, 'three/build/three.webgpu.js' ), three: join( packages, 'three/build/three.webgpu.js' ),
		'@peelnet/three/models': join( OURS, 'models' ), '@peelnet/three': join( OURS, 'src/index.js' )
	},
	// What Node.js has and browsers do not.
	external: [ 'fs', 'path', 'url', 'util', 'http', 'https', 'zlib', 'stream', 'crypto' ]
} );

const files = { '/': [ 'text/html', '<!doctype html><meta charset="utf-8"><link rel="icon" href="data:,"><body style="margin:0"><script type="module" src="/page.js"></script>' ], '/page.js': [ 'text/javascript', script.contents ] };

for ( const name of [ 'scene.glb', 'opaque.glb' ] ) files[ `/${ name }` ] = [ 'model/gltf-binary', readFileSync( join( folder, name ) ) ];

const server = createServer( ( { url }, response ) => {

	const [ type, content ] = files[ url ] ?? [];

	if ( type === undefined ) {

		console.error( `The page asks for ${ url }.` );
		response.writeHead( 404 ).end();

	}
	else response.setHeader( 'content-type', type ).end( content );

} );

await new Promise( ( done ) => server.listen( 0, '127.0.0.1', done ) );

const browser = await installed( 'puppeteer-core' ).launch( {
	executablePath: process.env.PEELNET_CHROMIUM ?? [ '/usr/bin/chromium', '/usr/bin/chromium-browser', '/usr/bin/google-chrome' ].find( existsSync ),
	args: [ '--use-angle=gl-egl', '--ignore-gpu-blocklist', '--no-sandbox' ], env: { ...process.env, LIBGL_ALWAYS_SOFTWARE: '1' }, protocolTimeout: 600_000
} );

try {

	const page = await browser.newPage();

	page.on( 'console', ( message ) => console.error( message.text() ) );
	page.on( 'pageerror', ( error ) => console.error( error ) );
	await page.setViewport( { width: scene.width, height: scene.height } );

	const answer = { times: {} };
	const load = async () => {

		await page.goto( `http://127.0.0.1:${ server.address().port }/` );
		await page.waitForFunction( 'window.drawn !== undefined', { timeout: 60_000 } );

	};

	await load();

	for ( const method of await page.evaluate( 'window.methods' ) ) {

		await load();

		const { picture, ms, adapter } = await page.evaluate( ( given, name ) => window.drawn( given, name ), scene, method );
		// Linear numbers of 8 bits, the lowest row first.
		const bytes = Buffer.from( picture, 'base64' );
		const row = 4 * scene.width;
		const header = `{'descr': '|u1', 'fortran_order': False, 'shape': (${ scene.height }, ${ scene.width }, 4), }`.padEnd( 117 ) + '\n';
		const rows = Array.from( { length: scene.height }, ( _, y ) => bytes.subarray( row * ( scene.height - 1 - y ), row * ( scene.height - y ) ) );

		writeFileSync( join( folder, `${ peer }-${ method.replaceAll( ' ', '-' ) }.npy` ), Buffer.concat( [ Buffer.from( [ 0x93, 0x4e, 0x55, 0x4d, 0x50, 0x59, 1, 0, 118, 0 ] ), Buffer.from( header ), ...rows ] ) );
		answer.adapter = `${ adapter } in ${ await browser.version() }`;

		if ( method !== 'opaque' ) answer.times[ method ] = ms;

	}

	console.log( JSON.stringify( answer ) );

} finally {

	await browser.close();
	server.close();

}
