// three.js: its sorting, its weighted blending, and @peelnet/three in it.

import * as THREE from 'three/webgpu';
import { pass } from 'three/tsl';
import { oitPass } from 'three/addons/tsl/display/OITPassNode.js';
import { GLTFLoader } from 'three/addons/loaders/GLTFLoader.js';
import { peelnetPass } from '@peelnet/three';
import medium from '@peelnet/three/models/medium.js';
import { peer } from './draw.js';

const method = ( file, node ) => async ( { camera: given, background, width, height } ) => {

	const renderer = new THREE.WebGPURenderer( { antialias: false, forceWebGL: true } );
	const camera = new THREE.PerspectiveCamera( given.fov_y, width / height, given.near, given.far );

	renderer.setPixelRatio( 1 );
	renderer.setSize( width, height );
	// Colours come out as they are blended.
	renderer.outputColorSpace = THREE.LinearSRGBColorSpace;
	document.body.append( renderer.domElement );
	await renderer.init();
	camera.position.set( ...given.position );
	camera.lookAt( ...given.target );

	const { scene: model } = await new GLTFLoader().loadAsync( `/${ file }.glb` );
	const scene = new THREE.Scene().add( model );

	scene.background = new THREE.Color().setRGB( ...background );

	const pipeline = new THREE.RenderPipeline( renderer, node( scene, camera ) );

	return {
		canvas: renderer.domElement,
		draw() {

			// Without the browser's frames every drawing must be said to be a new one, else passes are not drawn again.
			renderer._nodes.nodeFrame.update();
			pipeline.render();

		}
	};

};

peer( {
	opaque: method( 'opaque', pass ),
	'sorted blending': method( 'scene', pass ),
	'weighted blending': method( 'scene', oitPass ),
	'peelnet medium': method( 'scene', ( scene, camera ) => peelnetPass( scene, camera, { model: medium, onProblem: ( message ) => { throw new Error( message ); } } ) )
} );
