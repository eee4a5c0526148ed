// Order-independent transparency by an exported network, in PlayCanvas on WebGPU. RenderPassForward and RenderPassShaderQuad are exported by the
// engine, as is CameraComponent.framePasses, but its API reference leaves them out; all else is in it.

import {
	ADDRESS_CLAMP_TO_EDGE, BLENDEQUATION_ADD, BLENDEQUATION_MAX, BLENDMODE_ONE, BLENDMODE_ONE_MINUS_SRC_ALPHA, BlendState, BoundingSphere, CULLFACE_NONE, Color, FILTER_LINEAR, FILTER_NEAREST,
	Frustum, Layer, Mat4, MeshInstance, PIXELFORMAT_DEPTH, PIXELFORMAT_R16F, PIXELFORMAT_RG16F, PIXELFORMAT_RG8, PIXELFORMAT_RGBA16F, PIXELFORMAT_RGBA8, RenderPassForward, RenderPassShaderQuad,
	RenderTarget, SEMANTIC_POSITION, SORTMODE_NONE, ShaderMaterial, ShaderUtils, Texture
} from 'playcanvas';
import { aroundShader, passShader, resolveShader, spanOf, textureName } from './shaders.js';

const FORMATS = { r16float: PIXELFORMAT_R16F, rg8unorm: PIXELFORMAT_RG8, rg16float: PIXELFORMAT_RG16F, rgba8unorm: PIXELFORMAT_RGBA8, rgba16float: PIXELFORMAT_RGBA16F };
const EQUATIONS = { add: BLENDEQUATION_ADD, max: BLENDEQUATION_MAX };
const OVER = new BlendState( true, BLENDEQUATION_ADD, BLENDMODE_ONE, BLENDMODE_ONE_MINUS_SRC_ALPHA );

const VERTEX = `
attribute aPosition: vec3f;
uniform matrix_model: mat4x4f;
uniform matrix_viewProjection: mat4x4f;
varying depth: f32;

@vertex
fn vertexMain(input: VertexInput) -> VertexOutput {
	var output: VertexOutput;
	output.position = uniform.matrix_viewProjection * uniform.matrix_model * vec4f(input.aPosition, 1.0);
	// Of a perspective camera, w is the distance along the view axis.
	output.depth = output.position.w;
	return output;
}`;

const QUAD_VERTEX = `
attribute aPosition: vec2f;

@vertex
fn vertexMain(input: VertexInput) -> VertexOutput {
	var output: VertexOutput;
	output.position = vec4f(input.aPosition, 0.0, 1.0);
	return output;
}`;

// Draws no colour, only depth.
const NO_FRAGMENT = `
varying depth: f32;

@fragment
fn fragmentMain(input: FragmentInput) -> FragmentOutput {
	var output: FragmentOutput;
	output.color = vec4f();
	return output;
}`;

function passFragment( model, pass ) {

	const { head, body, outputs } = passShader( model, pass );

	return `
varying depth: f32;
uniform peelnet_color: vec4f;
uniform peelnet_span: vec4f;
uniform peelnet_size: vec2f;
${ head }

@fragment
fn fragmentMain(input: FragmentInput) -> FragmentOutput {
	let pixel = input.position.xy;
	let color = uniform.peelnet_color;
	let depth = input.depth;
	let span = uniform.peelnet_span;
	let size = uniform.peelnet_size;
	${ body }
	var output: FragmentOutput;
	${ outputs.map( ( output, i ) => `output.color${ i || '' } = ${ output };` ).join( '\n\t' ) }
	return output;
}`;

}

function quadFragment( { head, output } ) {

	return `
uniform peelnet_size: vec2f;
${ head }

@fragment
fn fragmentMain(input: FragmentInput) -> FragmentOutput {
	let pixel = input.position.xy;
	let size = uniform.peelnet_size;
	var output: FragmentOutput;
	output.color = ${ output };
	return output;
}`;

}

function makeTexture( device, name, format, { width, height }, filter = FILTER_NEAREST ) {

	return new Texture( device, { name: `peelnet ${ name }`, width, height, format, mipmaps: false, minFilter: filter, magFilter: filter, addressU: ADDRESS_CLAMP_TO_EDGE, addressV: ADDRESS_CLAMP_TO_EDGE } );

}

// Every attachment blends in its own way, also colour and alpha of one.
function blendState( targets ) {

	const [ first, ...others ] = targets.map( ( { color, alpha } ) => new BlendState( true, EQUATIONS[ color ], BLENDMODE_ONE, BLENDMODE_ONE, EQUATIONS[ alpha ], BLENDMODE_ONE, BLENDMODE_ONE ) );

	others.forEach( ( state, i ) => first.setAttachment( i + 1, state ) );

	return first;

}

function shaderMaterial( name, fragmentWGSL, state ) {

	const material = new ShaderMaterial( { uniqueName: `peelnet ${ name }`, vertexWGSL: VERTEX, fragmentWGSL, attributes: { aPosition: SEMANTIC_POSITION } } );

	return Object.assign( material, { cull: CULLFACE_NONE, ...state } );

}

// The same meshes once more, in a layer of a pass and with its material. The order does not matter, so nothing is sorted.
function makeLayer( app, name, instances, material, into ) {

	const layer = into ?? new Layer( { name: `peelnet ${ name }`, opaqueSortMode: SORTMODE_NONE, transparentSortMode: SORTMODE_NONE } );

	layer.addMeshInstances( instances.map( ( instance ) => {

		const copy = new MeshInstance( instance.mesh, material, instance.node );
		const { emissive, opacity } = instance.material;
		const { r, g, b } = new Color().linear( emissive );

		// The colour of the mesh's own material, here a StandardMaterial without light.
		copy.setParameter( 'peelnet_color', [ r, g, b, opacity ] );

		return copy;

	} ) );

	if ( into === undefined ) app.scene.layers.push( layer );

	return layer;

}

// Draws layers of a camera. A camera clears all attachments to one colour; here each has its own, or null.
class LayersPass extends RenderPassForward {

	constructor( app, target, camera, layers, clears, clearDepth ) {

		super( app.graphicsDevice, app.scene.layers, app.scene, app.renderer );
		this.clears = clears;
		this.clearsDepth = clearDepth;
		this.init( target );

		for ( const [ layer, isTransparent ] of layers ) this.addLayer( camera, layer, isTransparent, false );

	}

	frameUpdate() {

		super.frameUpdate();
		this.clears.forEach( ( color, i ) => this.setClearColor( color, i ) );
		this.setClearDepth( this.clearsDepth ? 1 : undefined );

	}

}

class QuadPass extends RenderPassShaderQuad {

	constructor( device, name, shader, textures, target, blend ) {

		super( device );
		this.shader = ShaderUtils.createShader( device, { uniqueName: `peelnet ${ name }`, attributes: { aPosition: SEMANTIC_POSITION }, vertexWGSL: QUAD_VERTEX, fragmentWGSL: quadFragment( shader ) } );
		this.blendState = blend;
		this.textures = new Map( shader.names.map( ( read ) => [ textureName( read ), textures.get( read ) ] ) );
		this.init( target );

	}

	execute() {

		for ( const [ name, texture ] of this.textures ) this.device.scope.resolve( name ).setValue( texture );

		super.execute();

	}

}

// The nearest and the farthest distance along the view axis of the boxes around what is in view.
function depthsOf( instances, { entity, projectionMatrix, viewMatrix } ) {

	const { forward } = entity;
	const frustum = new Frustum();

	// The camera's own is of its last frame.
	frustum.setFromMat4( new Mat4().mul2( projectionMatrix, viewMatrix ) );

	return instances.flatMap( ( { aabb: { center, halfExtents } } ) => {

		if ( frustum.containsSphere( new BoundingSphere( center, halfExtents.length() ) ) === 0 ) return [];

		const middle = center.clone().sub( entity.getPosition() ).dot( forward );
		const extent = halfExtents.x * Math.abs( forward.x ) + halfExtents.y * Math.abs( forward.y ) + halfExtents.z * Math.abs( forward.z );

		return [ middle - extent, middle + extent ];

	} );

}

/**
 * Passes that draw mesh instances with learned transparency into a texture, for `camera.framePasses`.
 *
 * @param {import('playcanvas').AppBase} app
 * @param {import('playcanvas').CameraComponent} camera - a perspective one; gets the layers of the passes
 * @param {object} model - of loadModel
 * @param {object} options - the mesh instances `transparent`, the layers `opaque`, `width` and `height`, and `clearColor`, a linear one
 * @returns {{ passes: object[], image: RenderTarget }} linear colours, to be tone mapped and encoded
 */
export function learnedTransparency( app, camera, model, { opaque, transparent, width, height, clearColor } ) {

	const device = app.graphicsDevice;
	const { around, passes } = model.description;
	const size = { width, height };
	const small = { width: Math.ceil( width / around.every ), height: Math.ceil( height / around.every ) };
	const target = ( name, colorBuffers, depthBuffer ) => new RenderTarget( { name: `peelnet ${ name }`, colorBuffers, depthBuffer, depth: depthBuffer !== undefined } );

	const depth = makeTexture( device, 'depth', PIXELFORMAT_DEPTH, size );
	const smallDepth = makeTexture( device, 'small depth', PIXELFORMAT_DEPTH, small );
	const image = target( 'image', [ makeTexture( device, 'image', PIXELFORMAT_RGBA16F, size ) ], depth );
	const quantiles = makeTexture( device, around.name, FORMATS[ around.format ], small, FILTER_LINEAR );
	const textures = new Map( [ [ around.name, quantiles ] ] );

	const opaqueInstances = opaque.flatMap( ( layer ) => layer.meshInstances );
	const depthOnly = shaderMaterial( 'depth', NO_FRAGMENT, { redWrite: false, greenWrite: false, blueWrite: false, alphaWrite: false } );
	const layers = [];
	const materials = [];

	const drawn = [ around.pass, ...passes ].map( ( pass ) => {

		const isSmall = pass === around.pass;
		const buffers = pass.targets.map( ( { name, format } ) => makeTexture( device, name, FORMATS[ format ], isSmall ? small : size ) );
		const material = shaderMaterial( pass.name, passFragment( model, pass ), { blendState: blendState( pass.targets ), depthWrite: false } );
		const layer = makeLayer( app, pass.name, transparent, material );

		for ( const name of pass.reads ) material.setParameter( textureName( name ), textures.get( name ) );

		// At this size it costs little to draw depth again.
		if ( isSmall ) makeLayer( app, pass.name, opaqueInstances, depthOnly, layer );

		layers.push( layer );
		materials.push( material );
		pass.targets.forEach( ( { name }, i ) => textures.set( name, buffers[ i ] ) );

		return [ target( pass.name, buffers, isSmall ? smallDepth : depth ), isSmall ? [ [ layer, false ], [ layer, true ] ] : [ [ layer, true ] ], pass.targets.map( ( { clear } ) => new Color( ...clear ) ), isSmall ];

	} );

	camera.layers = [ ...camera.layers, ...layers.map( ( layer ) => layer.id ) ];

	const [ aroundPass, ...full ] = drawn.map( ( [ into, list, clears, clearDepth ] ) => new LayersPass( app, into, camera, list, clears, clearDepth ) );
	const opaquePass = new LayersPass( app, image, camera, opaque.map( ( layer ) => [ layer, false ] ), [ clearColor ], true );

	app.on( 'prerender', () => {

		const span = spanOf( depthsOf( transparent, camera ), camera.nearClip, camera.farClip );

		for ( const material of materials ) material.setParameter( 'peelnet_span', span );

		device.scope.resolve( 'peelnet_size' ).setValue( [ width, height ] );

	} );

	return {
		image,
		passes: [
			opaquePass,
			aroundPass,
			new QuadPass( device, around.name, aroundShader( model ), textures, target( around.name, [ quantiles ] ), BlendState.NOBLEND ),
			...full,
			new QuadPass( device, 'resolve', resolveShader( model ), textures, image, OVER )
		]
	};

}
