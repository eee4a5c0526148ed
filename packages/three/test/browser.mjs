// A browser with a page of the tests in it. Needs Chromium: PEELNET_CHROMIUM is its path, else the usual ones are tried.

import { existsSync, readFileSync } from 'node:fs';
import { createServer } from 'node:http';
import { dirname, extname, join, normalize, sep } from 'node:path';
import { fileURLToPath } from 'node:url';
import puppeteer from 'puppeteer-core';

export const PACKAGE = dirname( dirname( fileURLToPath( import.meta.url ) ) );

const USUAL = [ '/usr/bin/chromium', '/usr/bin/chromium-browser', '/usr/bin/google-chrome', '/Applications/Google Chrome.app/Contents/MacOS/Google Chrome', 'C:\\Program Files\\Google\\Chrome\\Application\\chrome.exe' ];

// Software drawing, the same on machines with and without a graphics card. Without these WebGPU has no adapter when headless.
const FLAGS = [ '--enable-unsafe-webgpu', '--use-webgpu-adapter=swiftshader', '--enable-features=Vulkan', '--use-vulkan=swiftshader', '--use-angle=swiftshader', '--disable-vulkan-surface', '--enable-unsafe-swiftshader', '--js-flags=--expose-gc', '--no-sandbox' ];

const TYPES = { '.html': 'text/html', '.js': 'text/javascript', '.json': 'application/json', '.glb': 'model/gltf-binary' };

export function chromiumPath() {

	const path = process.env.PEELNET_CHROMIUM ?? USUAL.find( existsSync );

	if ( path === undefined || existsSync( path ) === false ) throw new Error( 'The tests need Chromium: install it (Debian: apt-get install chromium), or set PEELNET_CHROMIUM to the path of Chromium or Chrome.' );

	return path;

}

/** What a page's console says of errors; three.js reports those of shaders as warnings, too. */
export const errorsOf = ( said ) => said.filter( ( line ) => /^error/.test( line ) || ( /^warn/.test( line ) && /shader|wgsl|pipeline|validation/i.test( line ) ) );

/** Serves a folder's files on a free port of this machine. */
export async function serve( root ) {

	const server = createServer( ( request, response ) => {

		const path = normalize( join( root, decodeURIComponent( new URL( request.url, 'http://x' ).pathname ) ) );

		try {

			if ( path.startsWith( root + sep ) === false ) throw new Error( 'outside' );

			response.setHeader( 'content-type', TYPES[ extname( path ) ] ?? 'application/octet-stream' );
			response.end( readFileSync( path ) );

		} catch {

			response.writeHead( 404 ).end();

		}

	} );

	await new Promise( ( resolve ) => server.listen( 0, '127.0.0.1', resolve ) );

	return { url: `http://127.0.0.1:${ server.address().port }`, close: () => server.close() };

}

/** A browser at the page of the tests; `run( name, backend, options )` runs one of test/page/cases.js in a fresh page. */
export async function open( { root = PACKAGE, path = '/test/page/index.html', width = 640, height = 480 } = {} ) {

	const server = await serve( root );
	const browser = await puppeteer.launch( { executablePath: chromiumPath(), args: FLAGS, protocolTimeout: 600_000 } );
	const page = await browser.newPage();
	const said = [];

	page.on( 'console', ( message ) => said.push( `${ message.type() }: ${ message.text() }` ) );
	page.on( 'pageerror', ( error ) => said.push( `error: ${ error }` ) );
	await page.setViewport( { width, height } );

	const load = async () => {

		said.length = 0;
		await page.goto( server.url + path );
		await page.waitForFunction( 'window.ready === true', { timeout: 60_000 } );

	};

	return {
		browser, page, server, said, load,
		version: await browser.version(),
		async run( name, backend, options = {} ) {

			await load();

			return page.evaluate( ( n, b, o ) => window.runCase( n, b, o ), name, backend, options );

		},
		async close() {

			await browser.close();
			server.close();

		}
	};

}
