// Splats and glass, all drawn by one peelnetPass. A .splat file that is dropped onto the page, or chosen, replaces the splats.

import { RenderPipeline, WebGPURenderer } from 'three/webgpu';
import { pass } from 'three/tsl';
import { OrbitControls } from 'three/addons/controls/OrbitControls.js';
import { peelnetPass } from '@peelnet/three';
import small from '@peelnet/three/models/small';
import medium from '@peelnet/three/models/medium';
import large from '@peelnet/three/models/large';
import one from '@peelnet/three/models/one';
import { perspective } from '../../test/page/scenes.js';
import { cloud, splatScene } from './scene.js';
import { createSplats, splatsFrom } from './splats.js';

const MODELS = { small, medium, large, one };
const UNSORTED = 'three.js, splats unsorted';
const WIDTH = 640;
const HEIGHT = 480;
// The middle nine tenths of a file's centres, of each axis, are made as large as this: the rest are often strays.
const SIZE = 3;

const element = ( id ) => document.getElementById( id );
const message = ( text ) => ( element( 'message' ).textContent = text );

// Turns splats upright, since files have y downwards, and fits them to the glass.
function fit( mesh, { count, centers } ) {

	const ends = [ 0, 1, 2 ].map( ( k ) => {

		const sorted = Float32Array.from( { length: count }, ( _, i ) => centers[ 3 * i + k ] ).sort();

		return [ 0.05, 0.95 ].map( ( part ) => sorted[ Math.floor( part * ( count - 1 ) ) ] );

	} );
	const scale = SIZE / Math.max( ...ends.map( ( [ low, high ] ) => high - low ), 1e-6 );
	const [ x, y, z ] = ends.map( ( [ low, high ] ) => - scale * ( low + high ) / 2 );

	mesh.rotation.x = Math.PI;
	mesh.scale.setScalar( scale );
	mesh.position.set( x, - y, - z );

	return mesh;

}

async function start() {

	const isWebGL = new URLSearchParams( location.search ).get( 'backend' ) === 'webgl2';
	const renderer = new WebGPURenderer( { antialias: false, forceWebGL: isWebGL } );

	renderer.setSize( WIDTH, HEIGHT, false );
	element( 'view' ).append( renderer.domElement );
	await renderer.init();

	element( 'backend' ).textContent = isWebGL ? 'Draw with WebGPU' : 'Draw with WebGL 2';
	element( 'backend' ).href = isWebGL ? '?' : '?backend=webgl2';
	element( 'model' ).append( ...[ ...Object.keys( MODELS ), UNSORTED ].map( ( name ) => new Option( name, name, false, name === 'medium' ) ) );

	const camera = perspective( WIDTH / HEIGHT );
	const controls = new OrbitControls( camera, renderer.domElement );
	const first = splatsFrom( cloud() );
	let splats = createSplats( first );
	const scene = splatScene( splats );
	const pipeline = new RenderPipeline( renderer );
	// A still image is drawn once: how many frames are left to draw. The first may initialise what the next one uses.
	let left = 0;

	const changed = () => ( left = 2 );

	const build = () => {

		const { value } = element( 'model' );

		pipeline.outputNode?.dispose();
		pipeline.outputNode = value === UNSORTED ? pass( scene, camera, { samples: 0 } ) : peelnetPass( scene, camera, { model: MODELS[ value ], onProblem: message } );
		pipeline.needsUpdate = true;
		changed();

	};

	const show = ( mesh, { count } ) => {

		scene.remove( splats );
		splats.geometry.dispose();
		splats.material.dispose();
		splats = mesh;
		scene.add( splats );
		element( 'count' ).textContent = count === 1 ? '1 splat.' : `${ count } splats.`;

		changed();

		// For the tests of this page.
		window.results = { count, frames: 0, draw: () => pipeline.render() };

	};

	const open = async ( file ) => {

		if ( file === undefined ) return;

		try {

			const read = splatsFrom( await file.arrayBuffer() );

			show( fit( createSplats( read ), read ), read );
			message( '' );

		} catch ( error ) {

			// The splats that were there stay.
			message( `${ file.name }: ${ error.message }` );

		}

	};

	element( 'model' ).addEventListener( 'change', build );
	element( 'splats' ).addEventListener( 'change', ( { target } ) => open( target.files[ 0 ] ) );
	// A page takes dropped files only where it says so.
	window.addEventListener( 'dragover', ( event ) => event.preventDefault() );
	window.addEventListener( 'drop', ( event ) => {

		event.preventDefault();
		open( event.dataTransfer.files[ 0 ] );

	} );

	controls.addEventListener( 'change', changed );
	controls.target.set( 0, 0.2, 0 );
	camera.position.set( 1.2, 2.2, 5.4 );
	controls.update();
	build();
	show( splats, first );

	renderer.setAnimationLoop( () => {

		if ( left === 0 ) return;

		pipeline.render();
		left --;
		window.results.frames ++;

	} );

}

start().catch( ( error ) => message( `This page cannot draw: ${ error.message }` ) );
