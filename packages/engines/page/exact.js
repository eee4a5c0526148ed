// The exact image: a ray through the middle of every pixel, in 64 bits, and errors against it.

import { BACKGROUND, CAMERA, HEIGHT, WIDTH, add, cross, dot, normalized, scaled } from './scene.js';

// A rasteriser snaps corners to a grid, SwiftShader's to sixteenths of a pixel, so it may see other rectangles at a pixel's middle than a
// ray does. Pixels where rays that far off see others are left out.
const APART = 1 / 16;

const NEAR_ONE = [ [ 0, 0 ], [ APART, 0 ], [ - APART, 0 ], [ 0, APART ], [ 0, - APART ] ];

function rays() {

	const forward = normalized( add( CAMERA.target, CAMERA.position, - 1 ) );
	const right = normalized( cross( forward, [ 0, 1, 0 ] ) );
	const up = cross( right, forward );
	const half = Math.tan( CAMERA.fov / 2 );

	// Directions have length 1 along the view axis, so that distances are along it, too.
	return ( x, y ) => add( add( forward, right, ( 2 * x / WIDTH - 1 ) * half * WIDTH / HEIGHT ), up, ( 1 - 2 * y / HEIGHT ) * half );

}

function distanceTo( { center, u, v }, direction ) {

	const normal = cross( u, v );
	const distance = dot( add( center, CAMERA.position, - 1 ), normal ) / dot( direction, normal );
	const place = add( add( CAMERA.position, direction, distance ), center, - 1 );
	const isHit = distance > CAMERA.near && distance < CAMERA.far && Math.abs( dot( place, u ) ) <= dot( u, u ) && Math.abs( dot( place, v ) ) <= dot( v, v );

	return isHit ? distance : Infinity;

}

// What a ray sees: the nearest opaque rectangle, and transparent ones before and behind it.
function seenBy( { opaque, transparent }, direction ) {

	const distances = opaque.map( ( item ) => distanceTo( item, direction ) );
	const nearest = Math.min( ...distances );
	const hits = transparent.map( ( item, index ) => ( { item, index, distance: distanceTo( item, direction ) } ) ).filter( ( hit ) => hit.distance < Infinity );

	return {
		solid: nearest < Infinity ? distances.indexOf( nearest ) : - 1,
		before: hits.filter( ( hit ) => hit.distance < nearest ).sort( ( a, b ) => a.distance - b.distance ),
		behind: hits.filter( ( hit ) => hit.distance >= nearest )
	};

}

const signature = ( { solid, before } ) => `${ solid }:${ before.map( ( hit ) => hit.index ).sort().join() }`;

/** Linear RGBA from the top row on; `kept`, of pixels to compare; `covered`, of those whose glass is hidden by something opaque, all of it. */
export function exactImage( scene ) {

	const ray = rays();
	const image = new Float64Array( 4 * WIDTH * HEIGHT );
	const kept = new Uint8Array( WIDTH * HEIGHT );
	const covered = new Uint8Array( WIDTH * HEIGHT );

	for ( let i = 0; i < kept.length; i ++ ) {

		const [ x, y ] = [ i % WIDTH + 0.5, Math.floor( i / WIDTH ) + 0.5 ];
		const [ seen, ...beside ] = NEAR_ONE.map( ( [ dx, dy ] ) => seenBy( scene, ray( x + dx, y + dy ) ) );
		let color = seen.solid < 0 ? BACKGROUND : scene.opaque[ seen.solid ].color.slice( 0, 3 );

		for ( const { item } of seen.before.toReversed() ) color = add( scaled( color, 1 - item.color[ 3 ] ), item.color.slice( 0, 3 ), item.color[ 3 ] );

		image.set( [ ...color, 1 ], 4 * i );
		kept[ i ] = beside.every( ( other ) => signature( other ) === signature( seen ) ) ? 1 : 0;
		covered[ i ] = kept[ i ] && seen.before.length === 0 && seen.behind.length > 0 ? 1 : 0;

	}

	return { image, kept, covered };

}

/** A linear value as an sRGB display shows it, 0 to 255. */
export const shown = ( value ) => 255 * ( value <= 0.0031308 ? 12.92 * Math.max( value, 0 ) : 1.055 * Math.min( value, 1 ) ** ( 1 / 2.4 ) - 0.055 );

/** The root of the mean square and the greatest of the differences of what two images show, over the pixels of a mask. */
export function difference( a, b, mask ) {

	let sum = 0;
	let most = 0;
	let count = 0;

	for ( let i = 0; i < mask.length; i ++ ) {

		if ( mask[ i ] === 0 ) continue;

		for ( let k = 4 * i; k < 4 * i + 3; k ++ ) {

			const apart = Math.abs( shown( a[ k ] ) - shown( b[ k ] ) );

			sum += apart * apart;
			most = Math.max( most, apart );
			count ++;

		}

	}

	return { rmse: Math.sqrt( sum / count ), most, pixels: count / 3 };

}
