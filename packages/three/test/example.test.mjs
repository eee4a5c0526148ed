// The examples as they are built, in both back ends.

import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import { mkdirSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { after, before, describe, test } from 'node:test';
import { PACKAGE, errorsOf, open } from './browser.mjs';

const OUT = join( PACKAGE, 'out' );
const FOLDER = join( OUT, 'example' );

// A transparent triangle as a GLB: header, JSON chunk, binary chunk.
function triangle() {

	const positions = Buffer.from( new Float32Array( [ - 1, - 1, 0, 1, - 1, 0, 0, 1, 0 ] ).buffer );
	const json = {
		asset: { version: '2.0' }, scene: 0, scenes: [ { nodes: [ 0 ] } ], nodes: [ { mesh: 0 } ],
		meshes: [ { primitives: [ { attributes: { POSITION: 0 }, material: 0 } ] } ],
		materials: [ { alphaMode: 'BLEND', doubleSided: true, pbrMetallicRoughness: { baseColorFactor: [ 1, 0.2, 0.1, 0.5 ] } } ],
		accessors: [ { bufferView: 0, componentType: 5126, count: 3, type: 'VEC3', min: [ - 1, - 1, 0 ], max: [ 1, 1, 0 ] } ],
		bufferViews: [ { buffer: 0, byteLength: positions.length } ], buffers: [ { byteLength: positions.length } ]
	};
	const chunk = ( type, data, pad ) => {

		const padded = Buffer.concat( [ data, Buffer.alloc( ( 4 - data.length % 4 ) % 4, pad ) ] );
		const head = Buffer.alloc( 8 );

		head.writeUInt32LE( padded.length, 0 );
		head.write( type, 4, 'latin1' );

		return Buffer.concat( [ head, padded ] );

	};
	const body = Buffer.concat( [ chunk( 'JSON', Buffer.from( JSON.stringify( json ) ), ' ' ), chunk( 'BIN\0', positions, 0 ) ] );
	const head = Buffer.alloc( 12 );

	head.write( 'glTF', 0, 'latin1' );
	head.writeUInt32LE( 2, 4 );
	head.writeUInt32LE( 12 + body.length, 8 );

	return Buffer.concat( [ head, body ] );

}

// Bytes of one grey splat.
function splat() {

	const bytes = Buffer.alloc( 32 );

	[ 0, 0, 0, 1, 1, 1 ].forEach( ( value, k ) => bytes.writeFloatLE( value, 4 * k ) );
	bytes.set( [ 128, 128, 128, 255, 255, 128, 128, 128 ], 24 );

	return bytes;

}

let browser;

before( async () => {

	mkdirSync( OUT, { recursive: true } );

	const { status, stderr } = spawnSync( process.execPath, [ 'scripts/example.mjs', FOLDER ], { cwd: PACKAGE, encoding: 'utf8' } );

	assert.equal( status, 0, stderr );

	const glb = triangle();
	const files = { 'triangle.glb': glb, 'text.glb': Buffer.from( '<b>this is a text, not a GLB</b>' ), 'short.glb': Buffer.from( 'glTF' ), 'cut.glb': glb.subarray( 0, glb.length - 8 ) };

	for ( const [ name, data ] of Object.entries( files ) ) writeFileSync( join( OUT, name ), data );

	browser = await open( { root: FOLDER, path: '/index.html', width: 1200, height: 900 } );

} );

after( () => browser?.close() );

const judged = () => browser.page.waitForFunction( 'window.results !== undefined', { timeout: 120_000 } ).then( () => browser.page.evaluate( 'window.results' ) );

const textOf = ( id = 'message' ) => browser.page.$eval( `#${ id }`, ( element ) => element.textContent );

for ( const backend of [ 'webgpu', 'webgl2' ] ) {

	describe( `example, ${ backend }`, () => {

		test( 'draws three views and their errors', async () => {

			await browser.page.goto( `${ browser.server.url }/index.html?backend=${ backend }` );

			const { rmse: [ sorted, weighted, learned ], layers } = await judged();

			assert.equal( await textOf(), '' );
			assert.ok( layers > 10 );
			assert.ok( learned < sorted / 2 && learned < weighted / 3, `${ learned } ${ sorted } ${ weighted }` );

			// A canvas of WebGPU can be read only as a data URL here.
			const { image, brightness } = await browser.page.evaluate( async () => {

				const canvases = [ ...document.querySelectorAll( 'canvas' ) ];
				const all = document.createElement( 'canvas' );
				const context = all.getContext( '2d' );
				const { width, height } = canvases[ 0 ];

				Object.assign( all, { width: 3 * width, height: 2 * height } );

				// Views can be read in the frame that draws them, after it was drawn.
				const urls = await new Promise( ( resolve ) => requestAnimationFrame( () => resolve( canvases.map( ( canvas ) => canvas.toDataURL() ) ) ) );

				for ( const [ i, url ] of urls.entries() ) {

					const part = new Image();

					part.src = url;
					await part.decode();
					context.drawImage( part, ( i % 3 ) * width, Math.floor( i / 3 ) * height );

				}

				const brightness = [ 0, 1, 2 ].map( ( i ) => {

					const { data } = context.getImageData( i * width, 0, width, height );

					return data.reduce( ( sum, value, at ) => sum + ( at % 4 === 3 ? 0 : value ), 0 ) / data.length;

				} );

				return { image: all.toDataURL(), brightness };

			} );

			for ( const value of brightness ) assert.ok( value > 40, `a view is black: ${ brightness }` );


			writeFileSync( join( OUT, `example-${ backend }.png` ), Buffer.from( image.split( ',' )[ 1 ], 'base64' ) );

		} );

		test( 'a file that is no GLB is named, and the scene stays', async () => {

			const input = await browser.page.$( '#glb' );

			for ( const [ file, expected ] of [ [ 'text.glb', /no GLB: it does not begin/ ], [ 'short.glb', /no GLB: it is too short/ ], [ 'cut.glb', /damaged/ ] ] ) {

				await input.uploadFile( join( OUT, file ) );
				await browser.page.waitForFunction( ( source ) => new RegExp( source ).test( document.getElementById( 'message' ).textContent ), { timeout: 20_000 }, expected.source );

			}

			await browser.page.evaluate( 'delete window.results' );
			await input.uploadFile( join( OUT, 'triangle.glb' ) );

			// One surface, so one layer.
			assert.equal( ( await judged() ).layers, 1 );
			assert.equal( await textOf(), '' );

		} );

	} );

}

describe( 'example of splats', () => {

	const files = {
		'one.splat': splat(),
		'empty.splat': Buffer.alloc( 0 ),
		'scene.ply': Buffer.from( 'ply\nformat binary_little_endian 1.0\n' ),
		'cut.splat': splat().subarray( 0, 30 ),
		'text.splat': Buffer.from( 'a text of thirty-two bytes, no splat'.slice( 0, 32 ) ),
		'number.splat': Buffer.concat( [ splat(), Buffer.from( splat() ).fill( 0xff, 4, 8 ) ] ),
		'turn.splat': Buffer.from( splat() ).fill( 128, 28, 32 )
	};

	// A file is dropped as a browser would.
	const drop = ( name ) => browser.page.evaluate( ( fileName, bytes ) => {

		const dataTransfer = new DataTransfer();

		dataTransfer.items.add( new File( [ new Uint8Array( bytes ) ], fileName ) );
		window.dispatchEvent( new DragEvent( 'drop', { dataTransfer, cancelable: true } ) );

	}, name, [ ...files[ name ] ] );

	// The picture as a data URL, and how far its pixels are from their mean.
	const picture = async () => {

		await browser.page.waitForFunction( 'window.results?.frames > 1', { timeout: 120_000 } );

		return browser.page.evaluate( async () => {

			const canvas = document.querySelector( 'canvas' );

			// A canvas can be read in the task that draws it.
			window.results.draw();

			const url = canvas.toDataURL();
			const image = new Image();
			const context = Object.assign( document.createElement( 'canvas' ), { width: canvas.width, height: canvas.height } ).getContext( '2d' );

			image.src = url;
			await image.decode();
			context.drawImage( image, 0, 0 );

			const values = context.getImageData( 0, 0, canvas.width, canvas.height ).data.filter( ( _, i ) => i % 4 !== 3 );
			const mean = values.reduce( ( sum, value ) => sum + value, 0 ) / values.length;

			return { url, deviation: Math.sqrt( values.reduce( ( sum, value ) => sum + ( value - mean ) ** 2, 0 ) / values.length ) };

		} );

	};

	for ( const backend of [ 'webgpu', 'webgl2' ] ) {

		test( `${ backend }: shows splats and glass, and a dropped file in their place`, async () => {

			browser.said.length = 0;
			await browser.page.goto( `${ browser.server.url }/splats/index.html?backend=${ backend }` );

			const { url, deviation } = await picture();

			writeFileSync( join( OUT, `splats-${ backend }.png` ), Buffer.from( url.split( ',' )[ 1 ], 'base64' ) );
			assert.ok( deviation > 20, `an empty picture: ${ deviation }` );
			assert.equal( await textOf( 'message' ), '' );
			assert.match( await textOf( 'count' ), /^3200 splats/ );

			await drop( 'one.splat' );
			await browser.page.waitForFunction( 'window.results.count === 1' );
			assert.notEqual( ( await picture() ).url, url );
			assert.match( await textOf( 'count' ), /^1 splat\./ );
			assert.deepEqual( errorsOf( browser.said ), [] );

		} );

		test( `${ backend }: a bad file is named with what to do, and the splats stay`, async () => {

			const expected = {
				'empty.splat': /^empty\.splat: The file is empty\. Export the scene as \.splat/,
				'scene.ply': /^scene\.ply: The file is a PLY\. Export the scene as \.splat/,
				'cut.splat': /^cut\.splat: The file has 30 bytes, no multiple of 32: .* Export the scene as \.splat/,
				'text.splat': /^text\.splat: Splat 0 has no valid centre: .* Export the scene as \.splat/,
				'number.splat': /^number\.splat: Splat 1 has no valid centre: .* Export the scene as \.splat/,
				'turn.splat': /^turn\.splat: Splat 0 has no valid rotation: .* Export the scene as \.splat/
			};

			for ( const [ name, message ] of Object.entries( expected ) ) {

				await drop( name );
				await browser.page.waitForFunction( ( start ) => document.getElementById( 'message' ).textContent.startsWith( start ), { timeout: 20_000 }, name );
				assert.match( await textOf( 'message' ), message );

			}

			assert.match( await textOf( 'count' ), /^1 splat\./ );

			await drop( 'one.splat' );
			await browser.page.waitForFunction( 'document.getElementById( "message" ).textContent === ""' );
			assert.deepEqual( errorsOf( browser.said ), [] );

		} );

	}

} );
