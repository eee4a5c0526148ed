// The example's scene: a ring of splats around a ball of mist, three panes of coloured glass that cross both, and an opaque floor.

import { Color, DoubleSide, Mesh, MeshBasicMaterial, PlaneGeometry, Quaternion, Scene, Vector3 } from 'three/webgpu';
import { random } from '../../test/page/scenes.js';
import { SPLAT_BYTES, createSplats, splatsFrom } from './splats.js';

const RING_SPLATS = 3000;
const MIST_SPLATS = 200;

/** The ring and the mist as the bytes of a `.splat` file. The same seed makes the same bytes. */
export function cloud( seed = 1 ) {

	const next = random( seed );
	const buffer = new ArrayBuffer( ( RING_SPLATS + MIST_SPLATS ) * SPLAT_BYTES );
	const view = new DataView( buffer );
	const color = new Color();
	const up = new Vector3( 0, 0, 1 );
	const rotation = new Quaternion();
	let at = 0;

	const write = ( center, scales, opacity ) => {

		const { r, g, b } = color;
		const { w, x, y, z } = rotation;

		[ center.x, center.y, center.z, ...scales ].forEach( ( value, k ) => view.setFloat32( at + 4 * k, value, true ) );
		[ r, g, b, opacity ].forEach( ( value, k ) => view.setUint8( at + 24 + k, Math.round( 255 * value ) ) );
		[ w, x, y, z ].forEach( ( value, k ) => view.setUint8( at + 28 + k, Math.min( Math.round( 128 + 128 * value ), 255 ) ) );
		at += SPLAT_BYTES;

	};

	for ( let i = 0; i < RING_SPLATS; i ++ ) {

		const around = 2 * Math.PI * next();
		const across = 2 * Math.PI * next();
		const normal = new Vector3( Math.cos( across ) * Math.cos( around ), Math.sin( across ), Math.cos( across ) * Math.sin( around ) );
		const center = new Vector3( 1.35 * Math.cos( around ), 0, 1.35 * Math.sin( around ) ).addScaledVector( normal, 0.38 );

		// Flat on the ring's surface. `setRGB` and the like convert to linear light; the file holds display-space values.
		const lightness = 0.45 + 0.15 * Math.sin( 6 * around + 2 * across );
		const wave = ( k ) => lightness * ( 1 + 0.8 * Math.cos( around + k * 2.1 ) );

		color.r = Math.min( wave( 0 ), 1 );
		color.g = Math.min( wave( 1 ), 1 );
		color.b = Math.min( wave( 2 ), 1 );
		rotation.setFromUnitVectors( up, normal );
		write( center, [ 0.03 + 0.03 * next(), 0.03 + 0.03 * next(), 0.004 ], 0.5 + 0.5 * next() );

	}

	for ( let i = 0; i < MIST_SPLATS; i ++ ) {

		const center = new Vector3( 2 * next() - 1, 2 * next() - 1, 2 * next() - 1 ).clampLength( 0, 1 ).multiplyScalar( 0.6 );

		color.r = color.g = color.b = 0.75 + 0.2 * next();
		rotation.set( 2 * next() - 1, 2 * next() - 1, 2 * next() - 1, 1 ).normalize();
		write( center, [ 0.08 + 0.1 * next(), 0.08 + 0.1 * next(), 0.05 ], 0.05 + 0.1 * next() );

	}

	return buffer;

}

/** Three panes that cross the ring; two of them cross each other in its middle. */
export function glass() {

	const panes = [
		{ color: 0xe07020, opacity: 0.5, place: [ - 0.5, 0.1, 0.7 ], turn: 0.5 },
		{ color: 0x20a0c0, opacity: 0.45, place: [ 0.9, 0.15, 0.95 ], turn: - 0.5 },
		{ color: 0xc03080, opacity: 0.4, place: [ 0.1, 0.35, - 1 ], turn: - 0.2 }
	];

	return panes.map( ( { color, opacity, place, turn } ) => {

		const pane = new Mesh( new PlaneGeometry( 2.6, 1.7 ), new MeshBasicMaterial( { color, opacity, transparent: true, side: DoubleSide } ) );

		pane.position.set( ...place );
		pane.rotation.y = turn;

		return pane;

	} );

}

/** Splats of a file's bytes, or those of `cloud`, among the panes. */
export function splatScene( splats = createSplats( splatsFrom( cloud() ) ) ) {

	const scene = new Scene();
	const floor = new Mesh( new PlaneGeometry( 5, 5 ), new MeshBasicMaterial( { color: 0x5a5f58 } ) );

	floor.rotation.x = - Math.PI / 2;
	floor.position.y = - 0.75;
	scene.background = new Color( 0x30343c );
	scene.add( floor, splats, ...glass() );

	return scene;

}
