// The package in headless Chromium, on both back ends, against images peeled in the page.

import assert from 'node:assert/strict';
import { copyFileSync, mkdirSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { after, before, describe, test } from 'node:test';
import { PACKAGE, open } from './browser.mjs';

// One step of an 8-bit display.
const STEP = 1;
// Of the shown values of two drawings of the same thing, in steps: sums of 16-bit targets depend on the order of addition.
const REORDERED = 0.1;
// Two drawings with the same arithmetic differ by nothing.
const SAME = 0;
// Linear colours below 1 through targets of 16 bits, whose last bit there is 2^-11.
const HALF_SUMS = 2 ** - 11;
// What the issue asks of fifty objects: shares of the error of three.js's weighted OIT and of its sorting.
const OF_WEIGHTED = 1 / 3;
const OF_SORTED = 1 / 2;
// One geometry pass keeps the nearest fragment in 127 steps of a root: so far off are shown values, and linear ones, at most.
const ONE_SHOWN = 3;
const ONE_LINEAR = 0.02;
// Its error without the surroundings of each pixel.
const ONE_OF_SORTED = 0.6;
// What three sums of the last frame tell of the surroundings, beside sixteen bins of depth: the error at most, of that of the small pass.
const LAST_OF_SMALL = 1.5;
// What the issue asks of four samples: their error, of that of one.
const SAMPLED = 1.2;
// Eyes that are drawn together share one range of depth, and read one another's surroundings where they meet.
const EYES = 0.7;
// Numbers of at most 1 in 16 bits.
const MASKED = 2 ** - 11;
// A pixel of the cards' depth, in the scene's units, and what a depth texture of 24 bits tells apart of the farthest depth.
const HALF_PIXEL = 0.02;
// Tone mapping steepens differences: still less than a step in the mean.
const MAPPED = 1;

let browser;

before( async () => {

	browser = await open();

	const { three, agent } = await browser.run( 'versions', 'webgpu' );

	console.log( `three.js r${ three }, ${ browser.version }, ${ agent }` );

} );

after( () => browser?.close() );

// Three.js says what is wrong with shaders on the console only.
const shaderErrors = () => browser.said.filter( ( line ) => /shader|wgsl|pipeline|validation/i.test( line ) && /^error|^warn/.test( line ) );

const run = async ( name, backend, options ) => {

	const result = await browser.run( name, backend, options );

	assert.deepEqual( shaderErrors(), [] );

	return result;

};

for ( const backend of [ 'webgpu', 'webgl2' ] ) {

	describe( backend, () => {

		test( 'two cards are within one step of the exact image, with every model of several passes', async () => {

			const models = [ 'small', 'medium', 'large', 'anchored-small', 'anchored-medium', 'one' ];
			const result = await run( 'compared', backend, { scene: 'twoCards', models, ranges: [ 'pixel', 'frame' ] } );

			assert.equal( result.layers, 2 );
			assert.deepEqual( result.problems, [] );

			for ( const model of models ) for ( const range of [ 'pixel', 'frame' ] ) assert.ok( result[ `${ model }:${ range }` ].largest <= ( model === 'one' ? ONE_SHOWN : STEP ), `${ model }:${ range } ${ result[ `${ model }:${ range }` ].largest }` );

		} );

		for ( const scene of [ 'fifty', 'mixed' ] ) {

			for ( const camera of [ 'perspective', 'orthographic' ] ) {

				test( `${ scene } objects, ${ camera }: a third of the error of weighted OIT and half of sorting's`, async () => {

					const models = [ 'small', 'medium', 'large', 'one' ];
					const result = await run( 'compared', backend, { scene, camera, models, ranges: [ 'pixel', 'frame' ] } );

					assert.deepEqual( result.problems, [] );
					assert.ok( result.layers > 10, 'the scene has become an easy one' );

					for ( const model of models ) {

						for ( const range of [ 'pixel', 'frame' ] ) {

							const { rmse } = result[ `${ model }:${ range }` ];

							console.log( `    ${ model }:${ range } ${ rmse.toFixed( 2 ) }/255: ${ ( rmse / result.weighted.rmse ).toFixed( 3 ) } of weighted OIT's ${ result.weighted.rmse.toFixed( 2 ) }, ${ ( rmse / result.sorted.rmse ).toFixed( 3 ) } of sorting's ${ result.sorted.rmse.toFixed( 2 ) }` );
							assert.ok( rmse <= OF_WEIGHTED * result.weighted.rmse );
							assert.ok( rmse <= ( model === 'one' && range === 'frame' ? ONE_OF_SORTED : OF_SORTED ) * result.sorted.rmse );

						}

					}

				} );

			}

		}

		test( 'the four fragments of the exports have the colour that the exports name', async () => {

			for ( const name of [ 'small', 'medium', 'large', 'anchored-small', 'anchored-medium', 'one' ] ) {

				const { self_test: { pixel } } = JSON.parse( readFileSync( join( PACKAGE, '../../models', name, 'model.json' ), 'utf8' ) );
				// That of one is named without the surroundings.
				const [ range, most ] = name === 'one' ? [ 'frame', ONE_LINEAR ] : [ 'pixel', HALF_SUMS ];
				const color = await run( 'fourFragments', backend, { name, range, pixel } );

				for ( const k of [ 0, 1, 2 ] ) assert.ok( Math.abs( color[ k ] - pixel.color[ k ] ) <= most, `${ name }: ${ color } instead of ${ pixel.color }` );

			}

		} );

		test( 'range last: the first frame and that after a jump are those of the small pass, and a still image is nearly as good', async () => {

			const { first, settled, before, jumped, moved, problems } = await run( 'lastFrame', backend );

			console.log( `    range: 'last' ${ settled.rmse.toFixed( 2 ) }/255, with the small pass ${ before.rmse.toFixed( 2 ) }` );
			assert.deepEqual( problems, [] );
			assert.equal( first.largest, SAME );
			assert.equal( jumped.largest, SAME );
			assert.ok( moved.largest > SAME && moved.rmse <= before.rmse, String( moved.rmse ) );
			assert.ok( settled.rmse <= LAST_OF_SMALL * before.rmse );

		} );

		for ( const model of [ 'medium', 'one' ] ) {

			test( `${ model }: the order of the objects does not matter`, async () => {

				const { rmse } = await run( 'order', backend, { model } );

				assert.ok( rmse <= REORDERED, String( rmse ) );

			} );

			test( `${ model }: the first frame is like the others`, async () => {

				assert.equal( ( await run( 'firstFrame', backend, { model } ) ).largest, SAME );

			} );

			test( `${ model }: a viewport and a scissor cut as in three.js's pass`, async () => {

				const { same, whole } = await run( 'viewport', backend, { model } );

				assert.ok( same.largest <= STEP );
				assert.ok( whole.rmse > STEP, 'nothing was cut' );

			} );

			test( `${ model }: frames make nothing on the device`, async () => {

				assert.deepEqual( await run( 'steady', backend, { model } ), {} );

			} );

		}

		test( 'sizes and cameras change, and two passes share a frame', async () => {

			const result = await run( 'resized', backend );

			assert.deepEqual( result.sizes, [ [ 20, 160, 160 ], [ 40, 320, 320 ] ] );
			assert.equal( result.resized.largest, SAME );
			assert.equal( result.parallel.largest, SAME );
			assert.equal( result.back.largest, SAME );
			assert.ok( result.both.largest < STEP, `two passes in one frame: ${ result.both.largest }` );
			assert.ok( result.cameras.rmse > STEP, 'both cameras show the same' );

		} );

		test( 'tone mapping comes after it', async () => {

			const { plain, mapped } = await run( 'toneMapped', backend );

			assert.ok( plain.largest < 0.01 );
			assert.ok( mapped.rmse <= MAPPED );

		} );

		test( 'premultiplied materials', async () => {

			assert.equal( ( await run( 'premultiplied', backend ) ).largest, SAME );

		} );

		test( 'materials and renderer keep their settings; additive ones are drawn over the others', async () => {

			const result = await run( 'settings', backend );

			assert.equal( result.after, result.before );
			assert.ok( result.changed.rmse > STEP, 'the additive card looks like the other' );
			assert.ok( result.added.largest <= STEP );

		} );

		test( 'the range of depth is that of the boxes in view', async () => {

			// Of the camera at z = 7 to the objects of the case; the strip bends by its bones from z = 0 to 0.93 and to -0.47.
			assert.deepEqual( await run( 'depthRanges', backend ), {
				cards: [ 6, 9, true ],
				ignored: [ 6, 9, true ],
				instances: [ 6, 10, true ],
				moved: [ 6, 12, true ],
				clipped: [ 0.1, 9, true ],
				skinned: [ 6.068, 7.466, true ],
				given: [ 2, 20, true ]
			} );

		} );

		test( 'models change without leaks, and dispose frees all', async () => {

			const result = await run( 'memory', backend );

			assert.ok( result.withPass.total > result.before.total );
			assert.ok( result.withPass.renderObjects > result.before.renderObjects );

			for ( const key of [ 'total', 'textures', 'programs', 'uniformBuffers', 'renderTargets', 'renderObjects' ] ) {

				assert.equal( result.afterChanges[ key ], result.withPass[ key ], key );
				assert.equal( result.after[ key ], result.before[ key ], key );

			}

		} );

		test( 'a model that is set later draws as if it had been given first', async () => {

			const result = await run( 'swapped', backend );

			assert.ok( result.changed.rmse > 0, 'nothing changed' );
			assert.equal( result.fresh.largest, SAME );
			assert.equal( result.frame.largest, SAME );
			assert.equal( result.passes, 2 );

		} );

		test( 'bad input: one message each, and the scene is drawn sorted', async () => {

			const result = await run( 'bad', backend );
			const expected = {
				none: /no peelnet export/, 'no model': /no peelnet export/, version: /format version 2.*reads version 1/, recipe: /reads "front"/, format: /unknown format, blend or clear/,
				blend: /unknown format, blend or clear/, name: /unknown format, blend or clear/, text: /no WGSL text/, halves: /without --precision f16/, range: /neither "pixel" nor "frame" nor "last"/, samples: /samples is 3, and must be/, depth: /needs a depth buffer/,
				...( backend === 'webgpu' ? { compatibility: /compatibility mode/, bytes: /30 bytes a sample.*has 16/ } : { glsl: /no GLSL text/ } )
			};

			for ( const [ key, message ] of Object.entries( expected ) ) {

				assert.equal( result[ key ].problems.length, 1, key );
				assert.match( result[ key ].problems[ 0 ], message );
				assert.equal( result[ key ].largest, SAME, key );

			}

		} );

		if ( backend === 'webgl2' ) test( 'passes that a device cannot blend at once are drawn in parts', async () => {

			const result = await run( 'parts', backend );

			for ( const [ model, { passes, problems, rmse } ] of Object.entries( result ) ) {

				console.log( `    ${ model }: ${ passes } passes, ${ rmse.toFixed( 3 ) }/255` );
				assert.deepEqual( problems, [] );
				assert.ok( rmse <= REORDERED, model );

			}

			assert.deepEqual( result.one.passes, [ 2, 3 ] );

		} );

		test( 'a renderer with multisampling draws it', async () => {

			const { off, error } = await run( 'multisampled', backend );

			assert.deepEqual( off, [] );
			assert.ok( error <= STEP, String( error ) );

		} );

		for ( const camera of [ 'perspective', 'orthographic' ] ) {

			test( `four samples, ${ camera }: as close to four peeled images as one sample to one`, async () => {

				const { problems, one, four, without, previous, kept } = await run( 'sampled', backend, { camera } );

				console.log( `    four samples ${ four.toFixed( 2 ) }/255, one ${ one.toFixed( 2 ) }, one against the mean of four ${ without.toFixed( 2 ) }` );
				assert.deepEqual( problems, [] );
				assert.ok( four <= SAMPLED * one, `${ four } ${ one }` );
				assert.ok( without > 2 * four, 'the edges do not show' );
				assert.ok( previous <= REORDERED, String( previous ) );
				assert.equal( kept, true );

			} );

		}

		for ( const isXR of [ false, true ] ) {

			for ( const [ model, range ] of [ [ 'medium', 'pixel' ], [ 'medium', 'frame' ], [ 'one', 'pixel' ] ] ) {

				test( `${ isXR ? 'an XR session' : 'an array camera' }, ${ model }:${ range }: both eyes as each by itself`, async () => {

					const { problems, rmse, sorted, viewports } = await run( 'twoEyes', backend, { isXR, model, range } );

					console.log( `    ${ rmse.toFixed( 2 ) }/255 from each eye by itself, sorted ${ sorted.toFixed( 2 ) }` );
					assert.deepEqual( problems, [] );
					assert.ok( rmse <= EYES, String( rmse ) );
					assert.deepEqual( viewports, [ [ 0, 0, 160, 240 ], [ 160, 0, 160, 240 ] ] );

				} );

			}

		}

		test( 'glass writes its nearest depth, normal and velocity where enough is covered, and a mask', async () => {

			const [ written, not ] = [ await run( 'nearest', backend, { depthThreshold: 0.8 } ), await run( 'nearest', backend, { depthThreshold: 0.9, depthRange: [ 4, 10 ] } ) ];
			const { expected, depth, normal, velocity } = written;
			const [ near, far ] = expected.opacities;

			for ( const result of [ written, not ] ) {

				assert.deepEqual( result.problems, [] );
				assert.ok( Math.abs( result.coverage - ( 1 - ( 1 - near ) * ( 1 - far ) ) ) <= MASKED, String( result.coverage ) );
				assert.equal( result.coverageBeside, 0 );
				assert.equal( result.emptied, 0 );
				assert.ok( Math.abs( result.sparks - 0.1 ) <= HALF_SUMS, String( result.sparks ) );

			}

			// The middle of the image is the corner of a pixel: half a pixel of the card's depth away.
			assert.ok( Math.abs( depth - expected.depth ) <= HALF_PIXEL, `${ depth } ${ expected.depth }` );
			assert.ok( Math.abs( written.depthBeside - written.far ) <= HALF_PIXEL && Math.abs( not.depth - not.far ) <= HALF_PIXEL, `${ written.depthBeside } ${ not.depth }` );
			normal.forEach( ( value, k ) => assert.ok( Math.abs( value - expected.normal[ k ] ) <= MASKED, String( normal ) ) );
			assert.deepEqual( not.normal, [ 0, 0, 0 ] );
			assert.ok( Math.abs( velocity - expected.velocity ) <= HALF_SUMS && expected.velocity > 0.01, `${ velocity } ${ expected.velocity }` );

		} );

		test( 'the range of depth of instances and batches is that of as many meshes', async () => {

			const { meshes, instanced, batched } = await run( 'instances', backend );

			// The boxes of the meshes are computed in 64 bits, instances are kept in 32.
			for ( const range of [ instanced, batched ] ) range.forEach( ( z, i ) => assert.ok( Math.abs( z - meshes[ i ] ) <= 1e-5, `${ range } ${ meshes }` ) );

		} );

		test( 'three.js has every private field that is used', async () => assert.deepEqual( await run( 'privateFields', backend ), [] ) );

		if ( backend === 'webgpu' ) test( 'depth of field and ambient occlusion see the glass', async () => {

			const [ seen, not ] = [ await run( 'effects', backend, { depthThreshold: 0.5 } ), await run( 'effects', backend, { depthThreshold: null } ) ];

			mkdirSync( join( PACKAGE, 'out' ), { recursive: true } );

			for ( const [ name, { focused, occlusion } ] of [ [ 'with', seen ], [ 'without', not ] ] ) {

				writeFileSync( join( PACKAGE, 'out', `dof-${ name }-depth.png` ), Buffer.from( focused, 'base64' ) );
				writeFileSync( join( PACKAGE, 'out', `ao-${ name }-depth.png` ), Buffer.from( occlusion, 'base64' ) );

			}

			// In focus, every check of the glass is as sharp as it was drawn; without its depth it is blurred like the wall.
			assert.ok( seen.sharpness > 2 * not.sharpness, `${ seen.sharpness } ${ not.sharpness }` );

		} );

		test( 'a scene without transparent objects costs what three.js\'s pass costs', async () => {

			const result = await run( 'empty', backend );

			assert.equal( result.nothing.largest, SAME );
			assert.equal( result.again.largest, SAME );
			assert.equal( result.calls[ 0 ], result.calls[ 1 ] );
			assert.equal( result.calls[ 2 ], result.calls[ 1 ] + 6, 'the small pass, its depth and its sums, two passes and a resolve' );
			assert.ok( result.something.largest <= STEP );
			assert.equal( result.problem, null );

		} );

		test( 'labels that ignore depth and light that adds are drawn over the glass', async () => {

			const { problems, label, added, without } = await run( 'overAll', backend );

			assert.deepEqual( problems, [] );
			assert.ok( Math.max( label, added, without ) <= STEP, `${ label } ${ added } ${ without }` );

		} );

		test( 'objects are left out by their data, their material\'s and the option; so are own fragments and depths', async () => {

			const { depthNode, ...left } = await run( 'leftOut', backend );

			assert.equal( depthNode, false );

			for ( const [ how, error ] of Object.entries( left ) ) assert.ok( error <= STEP, `${ how }: ${ error }` );

		} );

		test( 'depths follow a material\'s own vertex node', async () => {

			for ( const [ camera, error ] of Object.entries( await run( 'vertexNodes', backend ) ) ) assert.ok( error <= STEP, `${ camera }: ${ error }` );

		} );

		test( 'an object that transmits light shows glass behind it, and glass before it, as in three.js', async () => {

			const { problems, largest } = await run( 'transmissive', backend );

			assert.deepEqual( problems, [] );
			assert.ok( largest <= STEP, String( largest ) );

		} );

		test( 'bundles are drawn object by object', async () => {

			const { first, later, kept } = await run( 'bundled', backend );

			assert.ok( Math.max( first, later ) <= STEP, `${ first } ${ later }` );
			assert.equal( kept, true );

		} );

		test( 'a disposed pass can be drawn again, and shows its last frame', async () => {

			const { problems, reused, previous } = await run( 'again', backend );

			assert.deepEqual( problems, [] );
			assert.ok( Math.max( reused, previous ) <= STEP, `${ reused } ${ previous }` );

		} );

		test( 'the stencil of opaque objects masks glass', async () => {

			const { problems, inside, outside } = await run( 'stencilled', backend );

			assert.deepEqual( problems, [] );
			assert.ok( Math.max( inside, outside ) <= STEP, `${ inside } ${ outside }` );

		} );

		test( 'further outputs keep what opaque objects wrote', async () => {

			const result = await run( 'outputs', backend );

			assert.deepEqual( result.problems, [] );
			assert.ok( Math.max( result.output, result.mark ) <= STEP, `${ result.output } ${ result.mark }` );

		} );

		test( 'one material for all, of the scene or of the pass', async () => {

			const { scene, pass, kept } = await run( 'overridden', backend );

			assert.ok( Math.max( scene, pass ) <= STEP, `${ scene } ${ pass }` );
			assert.equal( kept, true );

		} );

		test( 'disposed passes are collected', async () => {

			const { three, peelnet } = await run( 'collected', backend );

			// three.js holds what it drew last.
			assert.ok( peelnet <= Math.max( three, 1 ), `${ peelnet } of 6, and ${ three } of three.js's own` );

		} );

		test( 'after compileAsync the first frame compiles nothing', async () => {

			const { createShaderModule = 0, createRenderPipeline = 0, createShader = 0, createProgram = 0 } = await run( 'compiled', backend );

			// The quad that shows the pass, of the test's own pipeline.
			assert.ok( createRenderPipeline + createProgram <= 1, String( createRenderPipeline + createProgram ) );
			assert.ok( createShaderModule + createShader <= 2, String( createShaderModule + createShader ) );

		} );

		test( 'a model is loaded by its address', async () => {

			for ( const ending of [ 'json', 'wgsl', 'es.glsl' ] ) copyFileSync( join( PACKAGE, '../../models/medium', `model.${ ending }` ), join( PACKAGE, 'test/page', `model.${ ending }` ) );

			const { error, missing } = await run( 'loaded', backend );

			for ( const ending of [ 'json', 'wgsl', 'es.glsl' ] ) rmSync( join( PACKAGE, 'test/page', `model.${ ending }` ) );

			assert.ok( error <= STEP, String( error ) );
			assert.match( missing, /none\.(json|wgsl): 404/ );

		} );

		test( 'a lost device is reported once, and a disposed renderer is not', async () => {

			const { problems, silent } = await browser.run( 'lost', backend );

			assert.equal( problems.length, 1 );
			assert.match( problems[ 0 ], /device was lost/ );
			assert.deepEqual( silent, [] );

		} );

		test( 'the canvas shows it', async () => {

			const data = ( await run( 'picture', backend, {} ) ).replace( 'data:image/png;base64,', '' );

			mkdirSync( join( PACKAGE, 'out' ), { recursive: true } );
			writeFileSync( join( PACKAGE, 'out', `fifty-${ backend }.png` ), Buffer.from( data, 'base64' ) );

			// An empty canvas of this size is some kilobytes.
			assert.ok( data.length > 50_000 );

		} );

	} );

}
