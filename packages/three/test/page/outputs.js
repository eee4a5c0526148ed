// What a frame is drawn with and what it gives to other passes: samples, eyes, depth, masks, further outputs. By name like the cases.

import * as THREE from 'three/webgpu';
import { mrt, normalView, output, pass, velocity } from 'three/tsl';
import { ao } from 'three/addons/tsl/display/GTAONode.js';
import { dof } from 'three/addons/tsl/display/DepthOfFieldNode.js';
import { peelnetPass } from '@peelnet/three';
import { DepthRange } from '../../src/depth-range.js';
import { PRIVATE } from '../../src/private.js';
import { aspect, drawn, modelOf } from './helpers.js';
import { HEIGHT, WIDTH, errors, imageOf, makeRenderer, peeled, shown } from './measure.js';
import * as scenes from './scenes.js';

const at = ( image, x, y ) => Array.from( image.subarray( 4 * ( y * WIDTH + x ), 4 * ( y * WIDTH + x ) + 4 ) );
const middle = ( image ) => at( image, WIDTH / 2, HEIGHT / 2 );

// Where the ray through the middle of the image meets a card without rotation.
function met( camera, { position } ) {

	const direction = camera.getWorldDirection( new THREE.Vector3() );

	return direction.multiplyScalar( ( position.z - camera.position.z ) / direction.z ).add( camera.position );

}

/** Depth, coverage, normals and velocity of two cards, the near one of which moves. */
export async function nearest( backend, { depthThreshold, depthRange = null } ) {

	const renderer = await makeRenderer( backend );
	const scene = scenes.twoCards();
	const [ near ] = scene.children;
	const camera = scenes.perspective( aspect );
	const problems = [];
	const node = peelnetPass( scene, camera, { model: await modelOf( 'medium' ), depthThreshold, depthRange, onProblem: ( message ) => problems.push( message ) } );

	node.setMRT( mrt( { output, normal: normalView, velocity } ) );

	const image = await imageOf( renderer, node );
	const depth = await imageOf( renderer, node.getViewZNode() );
	const coverage = await imageOf( renderer, node.getCoverageNode() );
	const normal = await imageOf( renderer, node.getTextureNode( 'normal' ) );
	const moves = node.getTextureNode( 'velocity' );

	await imageOf( renderer, moves );
	near.position.x += 0.1;

	const velocities = await imageOf( renderer, moves, 1 );
	const here = met( camera, near );
	const before = here.clone().setX( here.x - 0.1 ).project( camera );
	const expected = {
		depth: here.clone().applyMatrix4( camera.matrixWorldInverse ).z,
		normal: new THREE.Vector3( 0, 0, 1 ).transformDirection( camera.matrixWorldInverse ).toArray(),
		velocity: here.clone().project( camera ).x - before.x,
		opacities: scene.children.map( ( { material } ) => material.opacity )
	};

	// Sparks behind both cards, which no depth of glass hides.
	const plain = middle( await imageOf( renderer, node ) );
	const spark = new THREE.Mesh( new THREE.PlaneGeometry( 1, 1 ), new THREE.MeshBasicMaterial( { color: new THREE.Color( 0.1, 0.1, 0.1 ), transparent: true, blending: THREE.AdditiveBlending } ) );

	spark.position.set( 0, 0.2, - 2 );
	scene.add( spark );

	const lit = middle( await imageOf( renderer, node ) );

	scene.clear();

	return {
		problems, expected, depth: middle( depth )[ 0 ], depthBeside: at( depth, 2, 2 )[ 0 ], far: - camera.far, coverage: middle( coverage )[ 0 ], coverageBeside: at( coverage, 2, 2 )[ 0 ],
		emptied: middle( await imageOf( renderer, node.getCoverageNode() ) )[ 0 ], normal: middle( normal ).slice( 0, 3 ), velocity: middle( velocities )[ 0 ], sparks: lit[ 0 ] - plain[ 0 ], image: middle( image )
	};

}

// The camera moved by a part of a pixel, in the plane of the image.
function moved( camera, [ x, y ] ) {

	const result = camera.clone();

	result.projectionMatrix.premultiply( new THREE.Matrix4().makeTranslation( ( 1 - 2 * x ) / WIDTH, ( 2 * y - 1 ) / HEIGHT, 0 ) );
	result.projectionMatrixInverse.copy( result.projectionMatrix ).invert();

	return result;

}

/** A scene with four samples a pixel, against the mean of four peeled images at the places of WebGPU's multisampling. */
export async function sampled( backend, { camera: cameraName = 'perspective' } = {} ) {

	const renderer = await makeRenderer( backend );
	const scene = scenes.fifty();
	const camera = scenes[ cameraName ]( aspect );
	const model = await modelOf( 'medium' );
	const one = await drawn( renderer, scene, camera, { model } );
	const single = await peeled( renderer, scene, camera );
	const mean = new Float64Array( single.image.length );

	for ( const place of [ [ 0.375, 0.125 ], [ 0.875, 0.375 ], [ 0.125, 0.625 ], [ 0.625, 0.875 ] ] ) {

		const { image } = await peeled( renderer, scene, moved( camera, place ) );

		image.forEach( ( value, i ) => ( mean[ i ] += value / 4 ) );

	}

	const { aspect: before, view } = camera;
	const four = await drawn( renderer, scene, camera, { model, samples: 4 } );
	const previous = await imageOf( renderer, four.node.getPreviousTextureNode(), 3 );

	return {
		problems: four.problems, one: errors( one.image, single.image ).rmse, four: errors( four.image, mean ).rmse, without: errors( one.image, mean ).rmse,
		previous: errors( previous, four.image ).rmse, kept: camera.aspect === before && ( camera.view ?? view )?.enabled !== true
	};

}

// Two eyes beside one another.
function eyes() {

	return [ - 0.3, 0.3 ].map( ( x, i ) => {

		const eye = scenes.perspective( aspect / 2 );

		eye.viewport = new THREE.Vector4( i * WIDTH / 2, 0, WIDTH / 2, HEIGHT );
		eye.position.x += x;
		eye.updateMatrixWorld();

		return eye;

	} );

}

/** Both eyes of an array, or of an XR session's camera, against each drawn by itself. */
export async function twoEyes( backend, { isXR = false, model = 'medium', range = 'pixel' } ) {

	const renderer = await makeRenderer( backend );
	const scene = scenes.fifty();
	const views = eyes();
	const array = new THREE.ArrayCamera( views );
	const options = { model: await modelOf( model ), range };

	// Frustum culling asks each eye.
	array.updateMatrixWorld();

	let both;

	if ( isXR ) {

		const target = new THREE.RenderTarget( WIDTH, HEIGHT );

		target.isXRRenderTarget = true;
		Object.assign( renderer.xr, { isPresenting: true, getCamera: () => array, updateCamera: () => {} } );
		renderer.setOutputRenderTarget( target );
		both = await drawn( renderer, scene, scenes.perspective( aspect ), options );
		renderer.setOutputRenderTarget( null );
		renderer.xr.isPresenting = false;

	} else {

		both = await drawn( renderer, scene, array, options );

	}

	const expected = new Float32Array( both.image.length );
	const sorted = await imageOf( renderer, pass( scene, array ) );

	for ( const eye of views ) {

		const node = peelnetPass( scene, eye, options );

		node.setViewport( eye.viewport.x, 0, WIDTH / 2, HEIGHT );

		const image = await imageOf( renderer, node );

		for ( let y = 0; y < HEIGHT; y ++ ) expected.set( image.subarray( 4 * ( y * WIDTH + eye.viewport.x ), 4 * ( y * WIDTH + eye.viewport.x + WIDTH / 2 ) ), 4 * ( y * WIDTH + eye.viewport.x ) );

	}

	return { problems: both.problems, ...errors( both.image, expected ), sorted: errors( sorted, expected ).rmse, viewports: views.map( ( { viewport } ) => viewport.toArray() ) };

}

/** The range of depth of instances and of a batch, against that of as many meshes. */
export async function instances() {

	const next = scenes.random( 3 );
	const geometry = new THREE.BoxGeometry( 1, 2, 3 );
	const camera = scenes.perspective( aspect );
	const matrices = Array.from( { length: 40 }, () => new THREE.Matrix4().compose(
		new THREE.Vector3( next(), next(), next() ), new THREE.Quaternion().setFromEuler( new THREE.Euler( next(), next(), next() ) ), new THREE.Vector3( next(), next(), next() )
	) );
	const range = ( objects ) => {

		const depths = new DepthRange();

		camera.updateMatrixWorld();

		for ( const object of objects ) {

			object.updateMatrixWorld( true );
			depths.add( object, camera.matrixWorldInverse );

		}

		return [ depths.near, depths.far ];

	};

	const instanced = new THREE.InstancedMesh( geometry, undefined, matrices.length );
	const batched = new THREE.BatchedMesh( matrices.length + 2, 24, 36 );
	const id = batched.addGeometry( geometry );
	const place = new THREE.Vector3( 0.5, - 0.2, 1 );

	// One that is gone and one that is not shown, both far away.
	const gone = batched.addInstance( id );
	const hidden = batched.addInstance( id );

	for ( const i of [ gone, hidden ] ) batched.setMatrixAt( i, new THREE.Matrix4().makeTranslation( 0, 0, - 50 ) );

	matrices.forEach( ( matrix, i ) => {

		instanced.setMatrixAt( i, matrix );
		batched.setMatrixAt( batched.addInstance( id ), matrix );

	} );

	batched.deleteInstance( gone );
	batched.setVisibleAt( hidden, false );

	for ( const object of [ instanced, batched ] ) object.position.copy( place );

	const meshes = matrices.map( ( matrix ) => {

		const mesh = new THREE.Mesh( geometry );

		mesh.matrixAutoUpdate = false;
		mesh.matrix.makeTranslation( place ).multiply( matrix );

		return mesh;

	} );

	return { meshes: range( meshes ), instanced: range( [ instanced ] ), batched: range( [ batched ] ) };

}

/** Which private fields of three.js are not there. */
export async function privateFields( backend ) {

	const renderer = await makeRenderer( backend );
	const { node } = await drawn( renderer, scenes.twoCards(), scenes.perspective( aspect ), { model: await modelOf( 'small' ) } );
	const objects = { [ backend ]: renderer, pass: node, batch: new THREE.BatchedMesh( 1, 3, 3 ) };
	const isMissing = ( object, path ) => path.split( '.' ).reduce( ( value, name ) => value?.[ name ], object ) === undefined;

	return Object.entries( objects ).flatMap( ( [ kind, object ] ) => PRIVATE[ kind ].filter( ( path ) => isMissing( object, path ) ).map( ( path ) => `${ kind }: ${ path }` ) );

}

/**
 * Depth of field and ambient occlusion of a checkered card of glass before a checkered wall, as pictures, and how sharp each is: the mean
 * difference of neighbours, of 255.
 */
export async function effects( backend, { depthThreshold } ) {

	const renderer = await makeRenderer( backend );
	const scene = scenes.lights( new THREE.Scene() );
	const camera = scenes.perspective( aspect );
	const checks = ( size, color, opacity ) => {

		const data = new Uint8Array( 4 * size * size );

		for ( let i = 0; i < size * size; i ++ ) data.set( ( i % size + Math.floor( i / size ) ) % 2 === 0 ? [ ...color, 255 ] : [ 240, 240, 240, 255 ], 4 * i );

		const map = new THREE.DataTexture( data, size, size );

		map.colorSpace = THREE.SRGBColorSpace;
		map.needsUpdate = true;

		return new THREE.MeshStandardMaterial( { map, transparent: opacity < 1, opacity, side: THREE.DoubleSide } );

	};

	const glass = new THREE.Mesh( new THREE.PlaneGeometry( 2, 2 ), checks( 16, [ 20, 60, 200 ], 0.85 ) );
	const wall = new THREE.Mesh( new THREE.PlaneGeometry( 16, 10 ), checks( 60, [ 120, 60, 20 ], 1 ) );
	const ball = new THREE.Mesh( new THREE.SphereGeometry( 0.5, 32, 24 ), new THREE.MeshStandardMaterial( { color: 0xb0e0a0, transparent: true, opacity: 0.8 } ) );

	glass.position.set( - 0.6, 0.3, 1.5 );
	ball.position.set( 0.5, - 0.2, 1.6 );
	wall.position.set( 0, 0, - 6 );
	scene.background = new THREE.Color( 0x202020 );
	scene.add( glass, wall, ball );

	const node = peelnetPass( scene, camera, { model: await modelOf( 'medium' ), depthThreshold } );

	node.setMRT( mrt( { output, normal: normalView } ) );

	const z = node.getViewZNode();
	const distance = - glass.position.clone().applyMatrix4( camera.matrixWorldInverse.copy( camera.matrixWorld ).invert() ).z;
	const focused = await imageOf( renderer, dof( node.getTextureNode(), z, distance, 1.5, 3 ) );
	const occlusion = await imageOf( renderer, ao( node.getTextureNode( 'depth' ), node.getTextureNode( 'normal' ), camera ) );
	const sharpness = ( { position }, spread ) => {

		const place = position.clone().project( camera );
		const x0 = Math.round( ( place.x + 1 ) / 2 * WIDTH );
		const y0 = Math.round( ( 1 - place.y ) / 2 * HEIGHT );
		let sum = 0;

		for ( let y = - spread; y < spread; y ++ ) for ( let x = - spread; x < spread; x ++ ) sum += Math.abs( shown( at( focused, x0 + x, y0 + y )[ 0 ] ) - shown( at( focused, x0 + x + 1, y0 + y )[ 0 ] ) );

		return sum / ( 4 * spread * spread );

	};

	return { sharpness: sharpness( glass, 20 ), focused: picture( focused ), occlusion: picture( occlusion.map( ( v, i ) => ( i % 4 === 3 ? 1 : occlusion[ i - i % 4 ] ) ) ) };

}

// An image of linear colours as the data of a PNG file.
function picture( image ) {

	const canvas = document.createElement( 'canvas' );

	Object.assign( canvas, { width: WIDTH, height: HEIGHT } );

	const context = canvas.getContext( '2d' );
	const data = context.createImageData( WIDTH, HEIGHT );

	data.data.set( Uint8ClampedArray.from( image, ( v, i ) => ( i % 4 === 3 ? 255 : Math.round( shown( v ) ) ) ) );
	context.putImageData( data, 0, 0 );

	return canvas.toDataURL().replace( 'data:image/png;base64,', '' );

}
