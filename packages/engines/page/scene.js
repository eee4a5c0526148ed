// The scene that both engines draw: rectangles alone, so that rays through them are the exact image. Colours are linear, and not lit.

export const WIDTH = 320;
export const HEIGHT = 240;

export const BACKGROUND = [ 0.05, 0.08, 0.12 ];

export const CAMERA = { position: [ 0.6, 1.7, 6.5 ], target: [ 0, 1.2, 0 ], fov: Math.PI / 4, near: 0.1, far: 50 };

const CARDS = 30;

export const add = ( a, b, scale = 1 ) => a.map( ( value, i ) => value + scale * b[ i ] );
export const dot = ( a, b ) => a[ 0 ] * b[ 0 ] + a[ 1 ] * b[ 1 ] + a[ 2 ] * b[ 2 ];
export const cross = ( a, b ) => [ a[ 1 ] * b[ 2 ] - a[ 2 ] * b[ 1 ], a[ 2 ] * b[ 0 ] - a[ 0 ] * b[ 2 ], a[ 0 ] * b[ 1 ] - a[ 1 ] * b[ 0 ] ];
export const scaled = ( a, scale ) => a.map( ( value ) => value * scale );
export const normalized = ( a ) => scaled( a, 1 / Math.hypot( ...a ) );

// A linear congruential generator: the same scene in every run.
function generator( state ) {

	return () => ( state = ( Math.imul( state, 1664525 ) + 1013904223 ) >>> 0 ) / 2 ** 32;

}

// A rectangle by its centre and the two vectors from there to the middles of its sides.
const rectangle = ( center, u, v, color ) => ( { center, u, v, color } );

function card( random ) {

	const between = ( low, high ) => low + ( high - low ) * random();
	const normal = normalized( [ between( - 1, 1 ), between( - 0.5, 0.5 ), between( - 1, 1 ) ] );
	const side = normalized( cross( normal, [ 0, 1, 0 ] ) );
	const center = [ between( - 1.6, 1.6 ), between( 0.4, 2.2 ), between( - 1.6, 1.6 ) ];

	return rectangle( center, scaled( side, between( 0.4, 1.1 ) ), scaled( cross( side, normal ), between( 0.4, 1.1 ) ), [ random(), random(), random(), between( 0.2, 0.85 ) ] );

}

function pillar( [ x, y, z ], half, height ) {

	const up = [ 0, height, 0 ];
	const face = ( dx, dz, shade ) => rectangle( [ x + dx * half, y + height, z + dz * half ], [ half * dz, 0, half * dx ], up, [ shade, shade * 0.9, shade * 0.7, 1 ] );

	return [ face( 1, 0, 0.35 ), face( - 1, 0, 0.25 ), face( 0, 1, 0.5 ), face( 0, - 1, 0.2 ), rectangle( [ x, y + 2 * height, z ], [ half, 0, 0 ], [ 0, 0, half ], [ 0.6, 0.55, 0.4, 1 ] ) ];

}

export function makeScene() {

	const random = generator( 7 );

	return {
		// One pillar before most cards, one among them.
		opaque: [ rectangle( [ 0, 0, 0 ], [ 4, 0, 0 ], [ 0, 0, 4 ], [ 0.25, 0.3, 0.25, 1 ] ), ...pillar( [ 0.9, 0, 1.9 ], 0.15, 0.9 ), ...pillar( [ - 0.7, 0, 0 ], 0.25, 1 ) ],
		transparent: Array.from( { length: CARDS }, () => card( random ) )
	};

}

export const corners = ( { center, u, v } ) => [ [ - 1, - 1 ], [ 1, - 1 ], [ 1, 1 ], [ - 1, 1 ] ].map( ( [ s, t ] ) => add( add( center, u, s ), v, t ) );
