// Order-independent transparency by an exported network, in Babylon.js on WebGPU. Public API alone.

import { Color4, Constants, EffectRenderer, EffectWrapper, MultiRenderTarget, RenderTargetTexture, ShaderLanguage, ShaderMaterial, Vector2, Vector3, Vector4 } from '@babylonjs/core';
import { aroundShader, passShader, resolveShader, spanOf, textureName } from './shaders.js';

// Blends of a target. Babylon.js has modes for both, but none that takes the maximum of colours and adds alpha: `medium` wants that, `small` does not.
const BLENDS = { 'add add': Constants.ALPHA_ONEONE_ONEONE, 'max max': Constants.ALPHA_MAX };

const FORMATS = { r: Constants.TEXTUREFORMAT_RED, rg: Constants.TEXTUREFORMAT_RG, rgba: Constants.TEXTUREFORMAT_RGBA };
const TYPES = { '8unorm': Constants.TEXTURETYPE_UNSIGNED_BYTE, '16float': Constants.TEXTURETYPE_HALF_FLOAT };

const VERTEX = `
attribute position: vec3f;
uniform worldViewProjection: mat4x4f;
varying depth: f32;

@vertex
fn main(input: VertexInputs) -> FragmentInputs {
	vertexOutputs.position = uniforms.worldViewProjection * vec4f(vertexInputs.position, 1.0);
	// Of a perspective camera, w is the distance along the view axis.
	vertexOutputs.depth = vertexOutputs.position.w;
}`;

const QUAD_VERTEX = `
attribute position: vec2f;

@vertex
fn main(input: VertexInputs) -> FragmentInputs {
	vertexOutputs.position = vec4f(vertexInputs.position, 0.0, 1.0);
}`;

// Draws no colour, only depth.
const NO_FRAGMENT = `
@fragment
fn main(input: FragmentInputs) -> FragmentOutputs {
	fragmentOutputs.color = vec4f(0.0);
}`;

function passFragment( model, pass ) {

	const { head, body, outputs } = passShader( model, pass );

	return `
varying depth: f32;
uniform color: vec4f;
uniform span: vec4f;
uniform size: vec2f;
${ head }

@fragment
fn main(input: FragmentInputs) -> FragmentOutputs {
	let pixel = fragmentInputs.position.xy;
	let color = uniforms.color;
	let depth = fragmentInputs.depth;
	let span = uniforms.span;
	let size = uniforms.size;
	${ body }
	${ outputs.map( ( output, i ) => `fragmentOutputs.fragData${ i } = ${ output };` ).join( '\n\t' ) }
}`;

}

function quadFragment( { head, output } ) {

	return `
uniform size: vec2f;
${ head }

@fragment
fn main(input: FragmentInputs) -> FragmentOutputs {
	let pixel = fragmentInputs.position.xy;
	let size = uniforms.size;
	fragmentOutputs.color = ${ output };
}`;

}

function shaderMaterial( scene, name, fragmentSource, options ) {

	const material = new ShaderMaterial( `peelnet ${ name }`, scene, { vertexSource: VERTEX, fragmentSource }, { attributes: [ 'position' ], shaderLanguage: ShaderLanguage.WGSL, ...options } );

	material.backFaceCulling = false;

	return material;

}

// What draws transparent meshes in one pass. Blending without a depth write follows from `needAlphaBlending`.
function passMaterial( scene, model, pass, textures ) {

	const material = shaderMaterial( scene, pass.name, passFragment( model, pass ), {
		uniforms: [ 'worldViewProjection', 'color', 'span', 'size' ],
		samplers: pass.reads.map( textureName ),
		needAlphaBlending: true
	} );

	pass.targets.forEach( ( { color, alpha }, i ) => {

		const mode = BLENDS[ `${ color } ${ alpha }` ];

		if ( mode === undefined ) throw new Error( `Babylon.js has no alpha mode that blends colour by ${ color } and alpha by ${ alpha }.` );

		material.setAlphaMode( mode, i );

	} );

	for ( const name of pass.reads ) material.setTexture( textureName( name ), textures.get( name ) );

	// The mesh keeps its own material: its colour is drawn, here that of a StandardMaterial without light.
	material.onBindObservable.add( ( { material: { emissiveColor: { r, g, b }, alpha } } ) => material.getEffect().setFloat4( 'color', r, g, b, alpha ) );

	return material;

}

function passTarget( scene, pass, size, hasDepth ) {

	const formats = pass.targets.map( ( { format } ) => format.match( /^(rgba|rg|r)(.+)$/ ) );
	const target = new MultiRenderTarget( `peelnet ${ pass.name }`, size, pass.targets.length, scene, {
		formats: formats.map( ( [ , channels ] ) => FORMATS[ channels ] ),
		types: formats.map( ( [ , , type ] ) => TYPES[ type ] ),
		samplingModes: formats.map( () => Constants.TEXTURE_NEAREST_SAMPLINGMODE ),
		generateDepthBuffer: hasDepth
	} );

	target.onClearObservable.add( ( engine ) => clear( engine, pass.targets, hasDepth ) );
	// Babylon.js itself ends the blending of the first target only.
	target.onAfterUnbindObservable.add( () => pass.targets.forEach( ( _, i ) => scene.getEngine().setAlphaMode( Constants.ALPHA_DISABLE, false, i ) ) );
	// The order does not matter, so nothing is sorted.
	target.setRenderingOrder( 0, null, null, () => 0 );

	return target;

}

// One clear fills all targets that are enabled with one colour. So those of one value are enabled at a time.
function clear( engine, targets, hasDepth ) {

	for ( const value of new Set( targets.map( ( target ) => target.clear.join() ) ) ) {

		engine.bindAttachments( engine.buildTextureLayout( targets.map( ( target ) => target.clear.join() === value ) ) );
		engine.clear( new Color4( ...value.split( ',' ).map( Number ) ), true, hasDepth );

	}

	engine.bindAttachments( engine.buildTextureLayout( targets.map( () => true ) ) );

}

function fullScreen( engine, name, shader, textures, size, alphaMode ) {

	const wrapper = new EffectWrapper( {
		engine, name: `peelnet ${ name }`, vertexShader: QUAD_VERTEX, fragmentShader: quadFragment( shader ), shaderLanguage: ShaderLanguage.WGSL,
		uniformNames: [ 'size' ], samplerNames: shader.names.map( textureName )
	} );

	wrapper.onApplyObservable.add( () => {

		for ( const read of shader.names ) wrapper.effect.setTexture( textureName( read ), textures.get( read ) );

		wrapper.effect.setVector2( 'size', size );
		engine.setAlphaMode( alphaMode );

	} );

	return wrapper;

}

// Distances along the view axis of the corners of the boxes around meshes in view.
function depthsOf( meshes, camera ) {

	const view = camera.getViewMatrix();
	const sign = camera.getScene().useRightHandedSystem ? - 1 : 1;

	for ( const mesh of meshes ) mesh.computeWorldMatrix();

	return meshes.filter( ( mesh ) => camera.isInFrustum( mesh ) )
		.flatMap( ( mesh ) => mesh.getBoundingInfo().boundingBox.vectorsWorld.map( ( corner ) => sign * Vector3.TransformCoordinates( corner, view ).z ) );

}

/**
 * Draws a scene's meshes with learned transparency into a texture, in every frame.
 *
 * @param {import('@babylonjs/core').Scene} scene
 * @param {import('@babylonjs/core').Camera} camera - a perspective one
 * @param {object} model - of loadModel
 * @param {object} options - the meshes `opaque` and `transparent`, `width` and `height`, and `clearColor`, a linear one
 * @returns {{ image: RenderTargetTexture, isReady: () => boolean }} linear colours, to be tone mapped and encoded
 */
export function learnedTransparency( scene, camera, model, { opaque, transparent, width, height, clearColor } ) {

	const engine = scene.getEngine();
	const { around, passes } = model.description;
	const size = { width, height };
	const small = { width: Math.ceil( width / around.every ), height: Math.ceil( height / around.every ) };
	const frame = new Vector2( width, height );
	const floats = { type: Constants.TEXTURETYPE_HALF_FLOAT, generateMipMaps: false, samplingMode: Constants.TEXTURE_NEAREST_SAMPLINGMODE };

	const image = new RenderTargetTexture( 'peelnet image', size, scene, { ...floats, generateDepthBuffer: true } );
	const quantiles = new RenderTargetTexture( 'peelnet quantiles', small, scene, { generateDepthBuffer: false, generateMipMaps: false, samplingMode: Constants.TEXTURE_BILINEAR_SAMPLINGMODE } );

	image.renderList = [ ...opaque ];
	image.clearColor = clearColor;

	const textures = new Map( [ [ around.name, quantiles ] ] );
	const depthOnly = shaderMaterial( scene, 'depth', NO_FRAGMENT, { uniforms: [ 'worldViewProjection' ] } );

	depthOnly.disableColorWrite = true;

	const drawn = [ around.pass, ...passes ].map( ( pass ) => {

		const isSmall = pass === around.pass;
		const target = passTarget( scene, pass, isSmall ? small : size, isSmall );
		const material = passMaterial( scene, model, pass, textures );

		pass.targets.forEach( ( { name }, i ) => textures.set( name, target.textures[ i ] ) );
		target.renderList = [ ...transparent ];
		target.setMaterialForRendering( transparent, material );

		if ( isSmall ) {

			// At this size it costs little to draw depth again. Opaque meshes come before transparent ones.
			target.renderList.push( ...opaque );
			target.setMaterialForRendering( opaque, depthOnly );

		} else {

			image.renderTarget.shareDepth( target.renderTarget );

		}

		return { target, material };

	} );

	const quads = new EffectRenderer( engine );
	const makeQuantiles = fullScreen( engine, 'quantiles', aroundShader( model ), textures, frame, Constants.ALPHA_DISABLE );
	const resolve = fullScreen( engine, 'resolve', resolveShader( model ), textures, frame, Constants.ALPHA_PREMULTIPLIED_PORTERDUFF );
	const targets = [ image, ...drawn.map( ( { target } ) => target ) ];

	for ( const target of targets ) target.activeCamera = camera;

	image.onBeforeRenderObservable.add( () => {

		const span = new Vector4( ...spanOf( depthsOf( transparent, camera ), camera.minZ, camera.maxZ ) );

		for ( const { material } of drawn ) material.setVector4( 'span', span ).setVector2( 'size', frame );

	} );
	targets[ 1 ].onAfterUnbindObservable.add( () => quads.render( makeQuantiles, quantiles ) );
	targets.at( - 1 ).onAfterUnbindObservable.add( () => {

		quads.render( resolve, image );
		// What is drawn next finds the state that opaque objects need.
		engine.setAlphaMode( Constants.ALPHA_DISABLE );

	} );

	// They are drawn in this order, before the scene's own camera.
	scene.customRenderTargets.push( ...targets );

	return { image, isReady: () => targets.every( ( target ) => target.isReadyForRendering() ) && makeQuantiles.effect.isReady() && resolve.effect.isReady() };

}
