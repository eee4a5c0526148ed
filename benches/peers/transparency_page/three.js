// three.js: its sorting, its weighted blending, and @peelnet/three in it.

import * as THREE from 'three/webgpu';
import { pass } from 'three/tsl';
import { oitPass } from 'three/addons/tsl/display/OITPassNode.js';
import { GLTFLoader } from 'three/addons/loaders/GLTFLoader.js';
import { peelnetPass } from '@peelnet/three';
import medium from '@peelnet/three/models/medium.js';
import { peer } from './draw.js';

peer( async ( { camera: given, background, width, height } ) => {

	const renderer = new THREE.WebGPURenderer( { antialias: false, forceWebGL: true } );
	const camera = new THREE.PerspectiveCamera( given.fov_y, width / height, given.near, given.far );
	const scenes = {};

	renderer.setPixelRatio( 1 );
	renderer.setSize( width, height );
	// Colours come out as they are blended.
	renderer.outputColorSpace = THREE.LinearSRGBColorSpace;
	document.body.append( renderer.domElement );
	await renderer.init();
	camera.position.set( ...given.position );
	camera.lookAt( ...given.target );

	for ( const name of [ 'scene', 'opaque' ] ) {

		( { scene: scenes[ name ] } = await new GLTFLoader().loadAsync( `/${ name }.glb` ) );
		const world = new THREE.Scene();

		world.add( scenes[ name ] );
		world.background = new THREE.Color().setRGB( ...background );
		scenes[ name ] = world;

	}

	const method = ( node ) => {

		const pipeline = new THREE.RenderPipeline( renderer, node );

		return {
			draw() {

				// Without the browser's frames every drawing must be said to be a new one, else passes are not drawn again.
				renderer._nodes.nodeFrame.update();
				pipeline.render();

			}
		};

	};

	const problems = [];
	const methods = {
		opaque: method( pass( scenes.opaque, camera ) ),
		'sorted blending': method( pass( scenes.scene, camera ) ),
		'weighted blending': method( oitPass( scenes.scene, camera ) ),
		'peelnet medium': method( peelnetPass( scenes.scene, camera, { model: medium, onProblem: ( message ) => { throw new Error( message ); } } ) )
	};

	return { version: THREE.REVISION, canvas: renderer.domElement, methods };

} );
