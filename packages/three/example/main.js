// One scene, drawn by three.js's sorting, by its weighted OIT and by a learned model, with each one's error against peeling.
// Each view has a renderer of its own; they share the scene.

import { RenderPipeline } from 'three/webgpu';
import { pass } from 'three/tsl';
import { OrbitControls } from 'three/addons/controls/OrbitControls.js';
import { oitPass } from 'three/addons/tsl/display/OITPassNode.js';
import { peelnetPass } from '@peelnet/three';
import small from '@peelnet/three/models/small';
import medium from '@peelnet/three/models/medium';
import large from '@peelnet/three/models/large';
import one from '@peelnet/three/models/one';
import { HEIGHT, WIDTH, errors, imageOf, makeRenderer, peeled, shown } from '../test/page/measure.js';
import { fifty, orthographic, perspective } from '../test/page/scenes.js';
import { sceneOf } from './glb.js';

const MODELS = { small, medium, large, one };
// An error of so many steps of 255 is white.
const WHITE = 32;
// Peeling waits until the camera has rested for so long.
const REST_MS = 400;

const element = ( id ) => document.getElementById( id );
const message = ( text ) => ( element( 'message' ).textContent = text );

function figure( parent, title, canvas ) {

	const result = document.createElement( 'figure' );
	const caption = document.createElement( 'figcaption' );

	caption.textContent = title;
	result.append( canvas, caption );
	element( parent ).append( result );

	return caption;

}

function blank() {

	const canvas = document.createElement( 'canvas' );

	canvas.width = WIDTH;
	canvas.height = HEIGHT;

	return canvas;

}

// Black, red, yellow, white. WebGL reads images from the bottom up.
function heat( canvas, image, exact, isFlipped ) {

	const context = canvas.getContext( '2d' );
	const data = context.createImageData( WIDTH, HEIGHT );

	for ( let i = 0; i < exact.length; i += 4 ) {

		const y = Math.floor( i / 4 / WIDTH );
		const to = i + ( isFlipped ? 4 * WIDTH * ( HEIGHT - 1 - 2 * y ) : 0 );

		const error = Math.max( ...[ 0, 1, 2 ].map( ( k ) => Math.abs( shown( image[ i + k ] ) - shown( exact[ i + k ] ) ) ) );
		const t = 3 * Math.min( error / WHITE, 1 );

		data.data.set( [ 255 * Math.min( t, 1 ), 255 * Math.min( Math.max( t - 1, 0 ), 1 ), 255 * Math.max( t - 2, 0 ), 255 ], to );

	}

	context.putImageData( data, 0, 0 );

}

async function start() {

	const backend = new URLSearchParams( location.search ).get( 'backend' ) === 'webgl2' ? 'webgl2' : 'webgpu';
	const renderers = [];

	for ( let i = 0; i < 3; i ++ ) renderers.push( await makeRenderer( backend ) );

	element( 'backend' ).textContent = backend === 'webgpu' ? 'Draw with WebGL 2' : 'Draw with WebGPU';
	element( 'backend' ).href = backend === 'webgpu' ? '?backend=webgl2' : '?';
	element( 'model' ).append( ...Object.keys( MODELS ).map( ( name ) => new Option( name, name, false, name === 'medium' ) ) );

	let scene = fifty();
	let camera = perspective( WIDTH / HEIGHT );
	let controls = [];
	let views = [];
	let changedAt = performance.now();
	let judged = false;

	const changed = () => {

		changedAt = performance.now();
		judged = false;

	};

	const choice = () => ( { model: MODELS[ element( 'model' ).value ], range: element( 'range' ).value, onProblem: message } );
	const panels = [ 'three.js, sorted', 'three.js, weighted OIT', 'peelnet' ].map( ( title, i ) => {

		const canvas = renderers[ i ].domElement;
		const heatMap = blank();

		figure( 'views', title, canvas );

		return { renderer: renderers[ i ], canvas, heatMap, caption: figure( 'errors', '', heatMap ) };

	} );

	const build = () => {

		for ( const { node, pipeline } of views ) {

			node.dispose();
			pipeline.dispose();

		}

		const nodes = [ pass( scene, camera, { samples: 0 } ), oitPass( scene, camera, { samples: 0 } ), peelnetPass( scene, camera, choice() ) ];

		views = nodes.map( ( node, i ) => ( { node, pipeline: new RenderPipeline( renderers[ i ], node ) } ) );
		controls.forEach( ( control ) => control.dispose() );
		controls = panels.map( ( { canvas } ) => {

			const control = new OrbitControls( camera, canvas );

			control.addEventListener( 'change', changed );

			return control;

		} );
		changed();

	};

	const judge = async () => {

		judged = true;

		const exact = await peeled( renderers[ 0 ], scene, camera );
		const results = [];

		for ( const [ i, { node } ] of views.entries() ) {

			const { renderer, heatMap, caption } = panels[ i ];
			const image = await imageOf( renderer, node, 1 );
			const { rmse, largest } = errors( image, exact.image );

			heat( heatMap, image, exact.image, backend === 'webgl2' );
			caption.textContent = `RMSE ${ rmse.toFixed( 2 ) } of 255, largest ${ largest.toFixed( 0 ) }`;
			results.push( rmse );

		}

		// For the tests of this page.
		window.results = { rmse: results, layers: exact.layers };

	};

	element( 'model' ).addEventListener( 'change', () => {

		views[ 2 ].node.model = choice().model;
		changed();

	} );

	element( 'range' ).addEventListener( 'change', () => {

		views[ 2 ].node.range = choice().range;
		changed();

	} );

	element( 'camera' ).addEventListener( 'change', ( { target } ) => {

		camera = ( target.value === 'orthographic' ? orthographic : perspective )( WIDTH / HEIGHT );
		build();

	} );

	element( 'glb' ).addEventListener( 'change', async ( { target } ) => {

		try {

			scene = await sceneOf( await target.files[ 0 ].arrayBuffer() );
			message( '' );
			build();

		} catch ( error ) {

			// The scene that was there stays.
			message( error.message );

		}

	} );

	build();

	let busy = false;

	renderers[ 0 ].setAnimationLoop( async () => {

		if ( busy ) return;

		busy = true;

		for ( const { pipeline } of views ) pipeline.render();

		if ( judged === false && performance.now() - changedAt > REST_MS ) await judge().catch( ( error ) => message( error.message ) );

		busy = false;

	} );

}

start().catch( ( error ) => message( `This page cannot draw: ${ error.message }` ) );
