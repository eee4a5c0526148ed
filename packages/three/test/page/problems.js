// Bad input, and scenes and devices without something, by name like the cases.

import { pass } from 'three/tsl';
import { peelnetPass } from '@peelnet/three';
import { aspect, drawn, modelOf, replaced } from './helpers.js';
import { errors, imageOf, makeRenderer, peeled } from './measure.js';
import * as scenes from './scenes.js';

/** Every bad input: its messages, and how far the image is from three.js's sorted one. */
export async function bad( backend ) {

	const renderer = await makeRenderer( backend );
	const scene = scenes.twoCards();
	const camera = scenes.perspective( aspect );
	const good = await modelOf( 'medium' );
	const sorted = await imageOf( renderer, pass( scene, camera ) );
	const result = {};

	const described = ( change ) => {

		const description = structuredClone( good.description );

		change( description );

		return { ...good, description };

	};

	const inputs = {
		none: {},
		'no model': { model: { weights: [] } },
		version: { model: described( ( d ) => ( d.format_version = 2 ) ) },
		recipe: { model: described( ( d ) => ( d.passes[ 1 ].reads = [ 'front' ] ) ) },
		format: { model: described( ( d ) => ( d.passes[ 1 ].targets[ 0 ].format = 'rgba64float' ) ) },
		blend: { model: described( ( d ) => ( d.passes[ 1 ].targets[ 0 ].color = 'min' ) ) },
		name: { model: described( ( d ) => ( d.passes[ 1 ].targets[ 0 ].name = 'x; }' ) ) },
		text: { model: { ...good, wgsl: '' } },
		halves: { model: { ...good, wgsl: `enable f16;\n${ good.wgsl }` } },
		glsl: { model: { ...good, glsl: null } },
		range: { model: good, range: 'tile' },
		samples: { model: good, samples: 3 },
		depth: { model: good, depthBuffer: false }
	};

	for ( const [ key, options ] of Object.entries( inputs ) ) {

		const { image, problems, node } = await drawn( renderer, scene, camera, options );

		result[ key ] = { problems, ...errors( image, sorted ) };
		node.dispose();

	}

	// The device's own limits, taken away one by one.
	const { backend: device } = renderer;
	const lacking = async ( key, object, name, value ) => {

		const { image, problems, node } = await replaced( object, name, value, () => drawn( renderer, scene, camera, { model: good } ) );

		result[ key ] = { problems, ...errors( image, sorted ) };
		node.dispose();

	};

	if ( backend === 'webgpu' ) {

		await lacking( 'compatibility', device, 'compatibilityMode', true );
		await lacking( 'bytes', device.device, 'limits', { maxColorAttachments: 8, maxColorAttachmentBytesPerSample: 16 } );

	}

	return result;

}

/** WebGL 2: passes that are drawn in parts, because the device cannot blend their targets at once, against whole ones. */
export async function parts( backend ) {

	const renderer = await makeRenderer( backend );
	const scene = scenes.fifty();
	const camera = scenes.perspective( aspect );
	const result = {};

	for ( const name of [ 'medium', 'one' ] ) {

		const draw = async () => drawn( renderer, scene, camera, { model: await modelOf( name ) } );
		const whole = await draw();
		const inParts = await replaced( renderer.backend, 'drawBuffersIndexedExt', null, draw );

		result[ name ] = { ...errors( inParts.image, whole.image ), passes: [ whole, inParts ].map( ( { node } ) => node._stages.passes.length ), problems: [ ...whole.problems, ...inParts.problems ] };

	}

	return result;

}

/** A renderer with multisampling. */
export async function multisampled( backend ) {

	const renderer = await makeRenderer( backend, { antialias: true } );
	const scene = scenes.twoCards();
	const camera = scenes.perspective( aspect );
	const { problems, image } = await drawn( renderer, scene, camera, { model: await modelOf( 'medium' ) } );
	const { image: exact } = await peeled( renderer, scene, camera );

	return { off: problems, error: errors( image, exact ).largest };

}

/** A scene without transparent objects costs what three.js's pass costs; and one that gets and loses them is drawn right. */
export async function empty( backend ) {

	const renderer = await makeRenderer( backend );
	const scene = scenes.twoCards();
	const cards = [ ...scene.children ];
	const camera = scenes.perspective( aspect );
	const model = await modelOf( 'medium' );
	const draws = async ( node ) => {

		await imageOf( renderer, node );

		const { calls } = renderer.info;
		const image = await imageOf( renderer, node, 1 );

		return { image, calls: renderer.info.calls - calls };

	};

	scene.remove( ...cards );

	const node = peelnetPass( scene, camera, { model } );
	const nothing = await draws( node );
	const plain = await draws( pass( scene, camera ) );

	scene.add( ...cards );

	const something = await draws( node );
	const exact = await peeled( renderer, scene, camera );

	scene.remove( ...cards );

	const again = await draws( node );

	return { nothing: errors( nothing.image, plain.image ), calls: [ nothing.calls, plain.calls, something.calls ], something: errors( something.image, exact.image ), again: errors( again.image, plain.image ), problem: node.problem };

}

/** What is said when the device is lost, and when it is destroyed on purpose. */
export async function lost( backend ) {

	const renderer = await makeRenderer( backend );

	// A page cannot lose a WebGPU device but by destroying it, which is no loss.
	const lose = () => backend === 'webgpu' ? renderer.onDeviceLost( { api: 'WebGPU', message: 'as if', reason: 'unknown' } ) : renderer.backend.extensions.get( 'WEBGL_lose_context' ).loseContext();

	const { problems } = await drawn( renderer, scenes.twoCards(), scenes.perspective( aspect ), { model: await modelOf( 'medium' ) } );
	const other = await makeRenderer( backend );
	const { problems: silent } = await drawn( other, scenes.twoCards(), scenes.perspective( aspect ), { model: await modelOf( 'medium' ) } );

	other.dispose();
	lose();
	await new Promise( ( resolve ) => setTimeout( resolve, 200 ) );

	return { problems, silent };

}
