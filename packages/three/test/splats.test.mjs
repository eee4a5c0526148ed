// Gaussian splats of the example, with glass, against closed forms and the peeled image, on both back ends. The page is tested in example.test.mjs.

import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { errorsOf, open } from './browser.mjs';

// Of shown values, in steps of 255: a pixel's sums, in 16 bits, of up to a hundred layers depend on the order of addition.
const REORDERED = 0.5;
// Where they do, a network may decide otherwise: in so many pixels of all, by more than so many steps.
const REORDERED_PIXELS = 1 / 1000;
const REORDERED_STEPS = 5;
// Error, of that of pass(), which sorts whole objects and no splats.
const OF_UNSORTED = { medium: 1 / 6, one: 1 / 3 };
// What a missing pane changes at least, in steps: it shows.
const SHOWS = 2;
// Three layers, linear: 16-bit targets.
const LAYERS = 2 ** - 10;
// A splat's opacity, of one layer.
const OPACITY = 2 ** - 9;
// Its depth, relative: the blur of 0.3 px² tilts the plane, and 24 bits of depth are kept.
const DEPTH = 0.001;

let browser;

before( async () => {

	browser = await open();

} );

after( () => browser?.close() );

const run = async ( ...call ) => {

	const result = await browser.run( ...call );

	assert.deepEqual( errorsOf( browser.said ), [] );

	return result;

};

test( 'a .splat file is read as antimatter15/splat writes it', async () => {

	assert.deepEqual( await run( 'splatsRead', 'webgpu' ), {
		count: 2, centers: [ 1, 2, 3, - 1, 0, 0 ], scales: [ 0.5, 0.25, 0.125, 1, 1, 1 ],
		rotations: [ - 0.5, 0.5, - 0.5, 0.5, 0, 0, 0, - 1 ], colors: [ 10, 20, 30, 40, 255, 0, 0, 255 ]
	} );

} );

for ( const backend of [ 'webgpu', 'webgl2' ] ) {

	for ( const opacity of [ 128, 255 ] ) {

		test( `${ backend }: a splat of opacity ${ opacity } between two panes has the colour of the three layers`, async () => {

			const { problems, found, expected } = await run( 'splatBetween', backend, { color: [ 200, 100, 50, opacity ] } );

			assert.deepEqual( problems, [] );
			found.forEach( ( value, k ) => assert.ok( Math.abs( value - expected[ k ] ) <= LAYERS, `${ found } instead of ${ expected }` ) );

		} );

	}

	for ( const [ what, options ] of Object.entries( { 'turned': {}, 'turned, beside the middle': { angle: - 1.1, x: 0.8 }, 'under an orthographic camera': { isOrthographic: true, x: 0.3 }, 'in a scaled mesh': { isScaled: true, x: 0.3 } } ) ) {

		test( `${ backend }: a flat splat, ${ what }, has its Gaussian's opacity and its plane's depth`, async () => {

			const { problems, pixels } = await run( 'splatShape', backend, options );

			assert.deepEqual( problems, [] );

			for ( const { found: [ opacity, depth ], expected } of pixels ) {

				assert.ok( Math.abs( opacity - expected[ 0 ] ) <= OPACITY, `opacity ${ opacity } instead of ${ expected[ 0 ] }` );
				assert.ok( Math.abs( depth / expected[ 1 ] - 1 ) <= DEPTH, `depth ${ depth } instead of ${ expected[ 1 ] }` );

			}

		} );

	}

	test( `${ backend }: the example is close to the exact image, in any order of the splats, and all glass shows`, async () => {

		const { layers, problems, unsorted, models } = await run( 'splatImages', backend, { models: Object.keys( OF_UNSORTED ), steps: REORDERED_STEPS } );

		assert.deepEqual( problems, [] );
		assert.ok( layers > 50, 'the scene has become an easy one' );

		for ( const [ name, { exact, reordered, without } ] of Object.entries( models ) ) {

			console.log( `    ${ name }: ${ exact.rmse.toFixed( 2 ) }/255 of ${ layers } layers, unsorted ${ unsorted.rmse.toFixed( 2 ) }; in another order ${ reordered.rmse.toFixed( 2 ) }, ${ ( 1e6 * reordered.beyond ).toFixed( 0 ) } pixels of a million by more than ${ REORDERED_STEPS }` );
			assert.ok( exact.rmse <= OF_UNSORTED[ name ] * unsorted.rmse );
			assert.ok( reordered.rmse <= REORDERED && reordered.beyond <= REORDERED_PIXELS, JSON.stringify( reordered ) );

			for ( const difference of without ) assert.ok( difference >= SHOWS, `${ without }` );

		}

	} );

}
