// What both pages share: the errors of the images that an engine drew, and the images on the page to be looked at.

import { loadModel } from '../../three/src/model.js';
import { difference, exactImage, shown } from './exact.js';
import { HEIGHT, WIDTH, makeScene } from './scene.js';

/** A model of the repository, as `peelnet export` wrote it. */
export const modelOf = ( name ) => loadModel( new URL( `/models/${ name }/model`, location.href ) );

// Validation errors, which engines may keep to themselves.
const errors = [];

if ( globalThis.GPUAdapter !== undefined ) {

	const { requestDevice } = GPUAdapter.prototype;

	GPUAdapter.prototype.requestDevice = async function ( ...options ) {

		const device = await requestDevice.apply( this, options );

		device.addEventListener( 'uncapturederror', ( { error } ) => errors.push( error.message ) );

		return device;

	};

}

export function makeCanvas() {

	const canvas = document.createElement( 'canvas' );

	// What the engines draw is read from their textures, and shown in canvases of its own.
	Object.assign( canvas, { width: WIDTH, height: HEIGHT, hidden: true } );
	document.body.append( canvas );

	return canvas;

}

/** Linear colours of what was read of a texture of 16 bits a channel, from the top row on. Babylon.js's begin at the bottom. */
export function fromHalves( data, fromBottom ) {

	const halves = new Float16Array( data.buffer, data.byteOffset, data.byteLength / 2 );
	const image = new Float64Array( 4 * WIDTH * HEIGHT );

	for ( let y = 0; y < HEIGHT; y ++ ) image.set( halves.subarray( 4 * WIDTH * y, 4 * WIDTH * ( y + 1 ) ), 4 * WIDTH * ( fromBottom ? HEIGHT - 1 - y : y ) );

	return image;

}

function show( name, image ) {

	const figure = document.createElement( 'figure' );
	const canvas = document.createElement( 'canvas' );

	Object.assign( canvas, { width: WIDTH, height: HEIGHT } );
	canvas.getContext( '2d' ).putImageData( new ImageData( Uint8ClampedArray.from( image, ( value, i ) => i % 4 === 3 ? 255 : shown( value ) ), WIDTH, HEIGHT ), 0, 0 );
	figure.append( canvas, document.createElement( 'br' ), name );
	document.body.append( figure );

}

/** Draws the scene once, once more in the opposite order, and by the engine's sorting; `draw( scene )` gives the images `network` and `sorted`. */
export async function measure( draw ) {

	const scene = makeScene();
	const { image: exact, kept, covered } = exactImage( scene );
	const { network, sorted, versions } = await draw( scene );
	const reversed = await draw( { ...scene, transparent: scene.transparent.toReversed() } );
	const everywhere = new Uint8Array( kept.length ).fill( 1 );

	for ( const [ name, image ] of Object.entries( { exact, network, sorted } ) ) show( name, image );

	return {
		versions, errors,
		network: difference( network, exact, kept ),
		sorted: difference( sorted, exact, kept ),
		reversed: difference( network, reversed.network, everywhere ),
		hidden: difference( network, exact, covered )
	};

}
