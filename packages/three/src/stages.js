// A model as three.js draws it: a render target and an MRT node for every pass, and a full-screen material that resolves.

import {
	AddEquation, BlendMode, CustomBlending, FloatType, HalfFloatType, MaxEquation, NearestFilter, NoBlending, NodeMaterial,
	OneFactor, OneMinusSrcAlphaFactor, OneMinusSrcColorFactor, QuadMesh, RGBAFormat, RGFormat, RedFormat, RenderTarget, UnsignedByteType, ZeroFactor
} from 'three/webgpu';
import { Fn, code, diffuseColor, ivec2, mrt, output, positionView, screenCoordinate, textureLoad, vec4, glslFn, wgslFn } from 'three/tsl';
import { isShaded, passesOf } from './model.js';
import { libraryText, passText, resolveText } from './shader-text.js';

const CHANNEL_FORMATS = { r: RedFormat, rg: RGFormat, rgba: RGBAFormat };
const TYPES = { '8unorm': UnsignedByteType, '16float': HalfFloatType, '32float': FloatType };

// [equation, source, destination] of colour and of alpha.
const BLEND_STATES = {
	add: [ AddEquation, OneFactor, OneFactor, OneFactor ],
	max: [ MaxEquation, OneFactor, OneFactor, OneFactor ],
	transmit: [ AddEquation, ZeroFactor, OneMinusSrcColorFactor, OneMinusSrcAlphaFactor ]
};

function blendMode( { color, alpha } ) {

	const mode = new BlendMode( CustomBlending );

	[ mode.blendEquation, mode.blendSrc, mode.blendDst ] = BLEND_STATES[ color ];
	[ mode.blendEquationAlpha, mode.blendSrcAlpha, , mode.blendDstAlpha ] = BLEND_STATES[ alpha ];

	return mode;

}

// A target of a description. Names are prefixed: three.js gives meaning to some, such as "depth".
const attachmentName = ( target ) => `peelnet_${ target.name }`;

function renderTarget( pass, depthTexture ) {

	const result = new RenderTarget( 1, 1, { count: pass.targets.length, samples: 0, minFilter: NearestFilter, magFilter: NearestFilter, generateMipmaps: false } );

	result.depthTexture = depthTexture;

	pass.targets.forEach( ( target, i ) => {

		const [ , channels, type ] = target.format.match( /^(rgba|rg|r)(.+)$/ );

		Object.assign( result.textures[ i ], { name: attachmentName( target ), format: CHANNEL_FORMATS[ channels ], type: TYPES[ type ] } );

	} );

	return result;

}

// What the material wrote, with the colour that it had before it was multiplied by its opacity.
const straightColor = /*@__PURE__*/ Fn( ( builder ) => {

	// three.js keeps as many channels of a material's output as the first target has.
	if ( builder.renderer.getRenderTarget().texture.format !== RGBAFormat ) return vec4( 0, 0, 0, diffuseColor.a );

	if ( builder.material.premultipliedAlpha !== true ) return output;

	return vec4( output.rgb.div( output.a.max( 1e-6 ) ), output.a );

} );

/** The passes of one model, ready to draw. `span` is the uniform of the frame's range of depth. */
export class Stages {

	constructor( model, range, { isGlsl, depthTexture, below, span } ) {

		const library = code( libraryText( model, isGlsl ), [], isGlsl ? 'glsl' : 'wgsl' );
		const native = ( text ) => ( isGlsl ? glslFn : wgslFn )( text, [ library ] );
		const texel = ivec2( screenCoordinate.xy );

		// The textures that earlier passes wrote, by the names of the description.
		const written = new Map();

		const texels = ( names ) => names.filter( ( name ) => written.has( name ) ).map( ( name ) => textureLoad( written.get( name ), texel ) );

		this.passes = passesOf( model.description, range ).map( ( pass ) => {

			const target = renderTarget( pass, depthTexture );
			const result = native( passText( model, pass, written, isGlsl ) )( straightColor(), positionView.z.negate(), span, ...texels( pass.reads ) ).toVar();
			const node = mrt( Object.fromEntries( pass.targets.map( ( description, i ) => [ attachmentName( description ), result.element( i ) ] ) ) );

			pass.targets.forEach( ( description, i ) => {

				const name = attachmentName( description );
				const [ r, g, b, a ] = description.clear;

				node.setBlendMode( name, blendMode( description ) ).setClearColor( name, 0, a );
				node.getClearColor( name ).setRGB( r, g, b );

				written.set( description.name, target.textures[ i ] );

			} );

			return { target, node, shaded: isShaded( pass ) };

		} );

		const material = new NodeMaterial();

		material.name = 'peelnet resolve';
		material.fragmentNode = native( resolveText( model, isGlsl ) )( textureLoad( below, texel ), ...texels( model.description.resolve_reads ) );
		material.blending = NoBlending;
		material.depthTest = material.depthWrite = material.fog = false;

		this.quad = new QuadMesh( material );

	}

	/** Takes size, viewport and scissor of the target of the opaque objects over. */
	setSize( { width, height, viewport, scissor, scissorTest } ) {

		for ( const { target } of this.passes ) {

			target.setSize( width, height );
			target.viewport.copy( viewport );
			target.scissor.copy( scissor );
			target.scissorTest = scissorTest;

		}

	}

	dispose() {

		for ( const { target } of this.passes ) {

			// The depth texture belongs to the opaque pass.
			target.depthTexture = null;
			target.dispose();

		}

		this.quad.material.dispose();

	}

}
