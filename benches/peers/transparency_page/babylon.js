// Babylon.js: its dual depth peeling ("order independent transparency") and its sorting.

import { Color4, Engine, FreeCamera, ImportMeshAsync, Scene, Vector3 } from '@babylonjs/core/index.js';
import '@babylonjs/loaders/glTF/2.0/index.js';
import { peer } from './draw.js';

const method = ( file, peeled ) => async ( { camera: given, background, width, height } ) => {

	const canvas = document.createElement( 'canvas' );

	Object.assign( canvas, { width, height } );
	document.body.append( canvas );

	const engine = new Engine( canvas, false, { antialias: false, audioEngine: false } );

	const scene = new Scene( engine );

	// The file's handedness.
	scene.useRightHandedSystem = true;
	scene.clearColor = new Color4( ...background, 1 );

	const camera = new FreeCamera( 'camera', new Vector3( ...given.position ), scene );

	camera.setTarget( new Vector3( ...given.target ) );
	camera.fov = given.fov_y * Math.PI / 180;
	camera.minZ = given.near;
	camera.maxZ = given.far;
	await ImportMeshAsync( `/${ file }.glb`, scene );

	// Materials encode colours for a display before they are blended: decoded before, they are blended as they are.
	for ( const material of scene.materials ) material.albedoColor = material.albedoColor.toLinearSpace();

	if ( peeled ) {

		scene.useOrderIndependentTransparency = true;
		// Two layers each; more than any pixel has: exact.
		scene.depthPeelingRenderer.passCount = 16;

	}

	await scene.whenReadyAsync();

	return { canvas, draw: () => scene.render() };

};

peer( { opaque: method( 'opaque', false ), 'sorted blending': method( 'scene', false ), 'dual depth peeling': method( 'scene', true ) } );
