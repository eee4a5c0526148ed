// The scene in Babylon.js.

import { Color3, Color4, Constants, Engine, FreeCamera, Mesh, RenderTargetTexture, Scene, StandardMaterial, Vector3, VertexData, WebGPUEngine } from '@babylonjs/core';
import { learnedTransparency } from '../babylon.js';
import { fromHalves, makeCanvas, measure, modelOf } from './measure.js';
import { BACKGROUND, CAMERA, HEIGHT, WIDTH, corners } from './scene.js';

function makeMesh( scene, item ) {

	const mesh = new Mesh( 'rectangle', scene );
	const material = new StandardMaterial( 'colour', scene );
	const [ r, g, b, alpha ] = item.color;

	Object.assign( new VertexData(), { positions: corners( item ).flat(), normals: Array( 4 ).fill( [ 0, 0, 1 ] ).flat(), indices: [ 0, 1, 2, 0, 2, 3 ] } ).applyToMesh( mesh );
	Object.assign( material, { disableLighting: true, backFaceCulling: false, emissiveColor: new Color3( r, g, b ), alpha } );
	mesh.material = material;

	return mesh;

}

function makeCamera( scene ) {

	const camera = new FreeCamera( 'camera', new Vector3( ...CAMERA.position ), scene );

	camera.setTarget( new Vector3( ...CAMERA.target ) );

	return Object.assign( camera, { fov: CAMERA.fov, minZ: CAMERA.near, maxZ: CAMERA.far } );

}

const read = async ( target ) => fromHalves( await target.readPixels( 0, 0, null, true, true ), true );

async function draw( engine, model, { opaque, transparent } ) {

	const scene = new Scene( engine );

	scene.useRightHandedSystem = true;

	const camera = makeCamera( scene );
	const meshes = { opaque: opaque.map( ( item ) => makeMesh( scene, item ) ), transparent: transparent.map( ( item ) => makeMesh( scene, item ) ) };
	const clearColor = new Color4( ...BACKGROUND, 1 );
	const { image, isReady } = learnedTransparency( scene, camera, model, { ...meshes, width: WIDTH, height: HEIGHT, clearColor } );

	// What Babylon.js draws by itself, into a texture as well.
	const sorted = new RenderTargetTexture( 'sorted', { width: WIDTH, height: HEIGHT }, scene, { type: Constants.TEXTURETYPE_HALF_FLOAT, generateMipMaps: false } );

	Object.assign( sorted, { activeCamera: camera, renderList: [ ...meshes.opaque, ...meshes.transparent ], clearColor } );
	scene.customRenderTargets.push( sorted );

	while ( ! ( isReady() && sorted.isReadyForRendering() ) ) await new Promise( requestAnimationFrame );

	for ( let i = 0; i < 2; i ++ ) {

		engine.beginFrame();
		scene.render();
		engine.endFrame();

	}

	const result = { network: await read( image ), sorted: await read( sorted ), versions: `Babylon.js ${ Engine.Version }` };

	scene.dispose();

	return result;

}

export async function run( { model: name } ) {

	const engine = new WebGPUEngine( makeCanvas(), { antialias: false } );

	await engine.initAsync();

	const model = await modelOf( name );

	return measure( ( scene ) => draw( engine, model, scene ) );

}
