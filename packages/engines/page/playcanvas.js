// The scene in PlayCanvas.

import {
	AppBase, AppOptions, BLEND_NORMAL, CULLFACE_NONE, CameraComponentSystem, Color, DEVICETYPE_WEBGPU, Entity, FILTER_NEAREST, GAMMA_NONE, GraphNode, Layer, Mesh, MeshInstance, PIXELFORMAT_RGBA16F,
	RenderPassForward, RenderTarget, StandardMaterial, TONEMAP_NONE, Texture, Vec3, createGraphicsDevice, version
} from 'playcanvas';
import { learnedTransparency } from '../playcanvas.js';
import { fromHalves, makeCanvas, measure, modelOf } from './measure.js';
import { BACKGROUND, CAMERA, HEIGHT, WIDTH, corners } from './scene.js';

function makeInstance( device, item ) {

	const mesh = new Mesh( device );
	const material = new StandardMaterial();
	const [ r, g, b, opacity ] = item.color;

	mesh.setPositions( corners( item ).flat() );
	mesh.setIndices( [ 0, 1, 2, 0, 2, 3 ] );
	mesh.update();
	Object.assign( material, { useLighting: false, useFog: false, useSkybox: false, cull: CULLFACE_NONE, diffuse: new Color( 0, 0, 0 ), emissive: new Color( r, g, b ).gamma(), opacity } );
	if ( opacity < 1 ) Object.assign( material, { blendType: BLEND_NORMAL, depthWrite: false } );
	material.update();

	return new MeshInstance( mesh, material, new GraphNode() );

}

function makeLayer( app, name, items ) {

	const layer = new Layer( { name } );

	layer.addMeshInstances( items.map( ( item ) => makeInstance( app.graphicsDevice, item ) ) );
	app.scene.layers.push( layer );

	return layer;

}

function makeCamera( app, layers ) {

	const entity = new Entity();

	entity.addComponent( 'camera', { fov: CAMERA.fov * 180 / Math.PI, nearClip: CAMERA.near, farClip: CAMERA.far, layers: layers.map( ( layer ) => layer.id ), gammaCorrection: GAMMA_NONE, toneMapping: TONEMAP_NONE, clearColor: new Color( ...BACKGROUND ) } );
	entity.setPosition( ...CAMERA.position );
	entity.lookAt( new Vec3( ...CAMERA.target ) );
	app.root.addChild( entity );

	return entity.camera;

}

// What PlayCanvas draws by itself, into a texture as well.
function sortedPass( app, camera, opaque, transparent ) {

	const pass = new RenderPassForward( app.graphicsDevice, app.scene.layers, app.scene, app.renderer );
	const colorBuffer = new Texture( app.graphicsDevice, { width: WIDTH, height: HEIGHT, format: PIXELFORMAT_RGBA16F, mipmaps: false, minFilter: FILTER_NEAREST, magFilter: FILTER_NEAREST } );

	pass.init( new RenderTarget( { colorBuffer, depth: true } ) );
	pass.addLayer( camera, opaque, false );
	pass.addLayer( camera, transparent, true );

	return pass;

}

const read = async ( { colorBuffer } ) => fromHalves( await colorBuffer.read( 0, 0, WIDTH, HEIGHT, { immediate: true } ), false );

async function draw( app, model, items ) {

	const opaque = makeLayer( app, 'opaque', items.opaque );
	const transparent = makeLayer( app, 'transparent', items.transparent );
	const camera = makeCamera( app, [ opaque, transparent ] );
	const { passes, image } = learnedTransparency( app, camera, model, { opaque: [ opaque ], transparent: transparent.meshInstances, width: WIDTH, height: HEIGHT, clearColor: new Color( ...BACKGROUND ) } );
	const sorted = sortedPass( app, camera, opaque, transparent );

	camera.framePasses = [ ...passes, sorted ];

	for ( let i = 0; i < 2; i ++ ) {

		app.renderNextFrame = true;
		await new Promise( ( resolve ) => app.once( 'frameend', resolve ) );

	}

	const result = { network: await read( image ), sorted: await read( sorted.renderTarget ), versions: `PlayCanvas ${ version }` };

	camera.entity.destroy();

	return result;

}

export async function run( { model: name } ) {

	const canvas = makeCanvas();
	const device = await createGraphicsDevice( canvas, { deviceTypes: [ DEVICETYPE_WEBGPU ], antialias: false } );
	const app = new AppBase( canvas );

	app.init( Object.assign( new AppOptions(), { graphicsDevice: device, componentSystems: [ CameraComponentSystem ] } ) );
	// Frames are drawn when they are asked for.
	app.autoRender = false;
	app.start();

	const model = await modelOf( name );

	return measure( ( scene ) => draw( app, model, scene ) );

}
