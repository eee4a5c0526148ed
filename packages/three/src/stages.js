// A model as three.js draws it: a render target and an MRT node for every pass, and a full-screen material that resolves.

import {
	AddEquation, AlwaysDepth, BlendMode, CustomBlending, DepthStencilFormat, DepthTexture, FloatType, HalfFloatType, LinearFilter, MaxEquation, NearestFilter, OneFactor,
	OneMinusSrcAlphaFactor, OneMinusSrcColorFactor, RGBAFormat, RGFormat, RedFormat, RenderTarget, UnsignedByteType, UnsignedIntType, Vector4, ZeroFactor
} from 'three/webgpu';
import { Fn, cameraProjectionMatrixInverse, code, diffuseColor, glslFn, ivec2, mat4, mrt, output, positionView, renderGroup, screenCoordinate, screenSize, screenUV, texture, textureLoad, uniform, varying, vec2, vec4, wgslFn } from 'three/tsl';
import { KEEP, TOGETHER, fullScreen, over } from './full-screen.js';
import { isShaded } from './model.js';
import { aroundText, libraryText, passText, resolveText, sumText } from './shader-text.js';

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

function renderTarget( targets, depthTexture, filter = NearestFilter ) {

	const stencilBuffer = depthTexture?.format === DepthStencilFormat;
	const result = new RenderTarget( 1, 1, { count: targets.length, samples: 0, minFilter: filter, magFilter: filter, generateMipmaps: false, depthBuffer: depthTexture !== null, stencilBuffer, depthTexture } );

	targets.forEach( ( target, i ) => {

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

// Distance along the view axis: of where a material's own vertex node puts the vertex, if it has one.
const distance = /*@__PURE__*/ Fn( ( { material } ) => {

	if ( material.vertexNode?.isNode !== true ) return positionView.z.negate();

	const view = cameraProjectionMatrixInverse.mul( varying( vec4( material.vertexNode ) ) );

	return view.z.div( view.w ).negate();

} );

// What the nearest fragment writes where enough is covered: its depth, and all outputs but the image. Fragments that nobody sees write none.
function surface( covered, threshold, outputs ) {

	const kept = Fn( () => {

		covered.lessThan( threshold ).or( output.a.lessThan( 1 / 255 ) ).discard();

		return vec4( 0 );

	} )();

	return mrt( { ...outputs?.outputNodes, output: kept } ).setBlendMode( 'output', KEEP );

}

// Sums over a texel of a full-screen pass and the eight around it: what `read` finds there, a pixel and what is kept of it.
function sumAround( read, add ) {

	const texel = ivec2( screenCoordinate.xy );
	const last = ivec2( screenSize ).sub( 1 );
	let sum = mat4( vec4( 0 ), vec4( 0 ), vec4( 0 ), vec4( 0 ) );

	for ( const x of [ - 1, 0, 1 ] ) for ( const y of [ - 1, 0, 1 ] ) {

		const at = texel.add( ivec2( x, y ) ).clamp( ivec2( 0 ), last ).toVar();

		sum = add( sum, ...read( at ) ).toVar();

	}

	return sum;

}

/** The passes of one model, ready to draw. `span` is the uniform of the frame's range of depth. */
export class Stages {

	constructor( model, passes, { isGlsl, depthTexture, span, outputs, fromLast, coverage, threshold } ) {

		const { around, resolve_reads } = model.description;
		const library = code( libraryText( model, isGlsl ), [], isGlsl ? 'glsl' : 'wgsl' );
		const native = ( text ) => ( isGlsl ? glslFn : wgslFn )( text, [ library ] );
		const pixel = screenCoordinate.xy;
		const texel = ivec2( pixel );
		const viewport = uniform( new Vector4() ).setGroup( renderGroup );

		// What earlier passes wrote at the pixel, by the names of the description, and the small textures.
		const written = new Map();
		const small = new Map();
		const kept = new Map();
		// Without a stencil.
		const smallDepth = new DepthTexture( 1, 1, depthTexture.format === DepthStencilFormat ? UnsignedIntType : depthTexture.type );

		const texels = ( names ) => names.filter( ( name ) => written.has( name ) ).map( ( name ) => written.get( name ) );

		this.passes = passes.map( ( pass ) => {

			const isSmall = pass.name === around?.pass.name;
			const target = renderTarget( pass.targets, isSmall ? smallDepth : depthTexture );
			const node = mrt( {} );
			let columns;

			pass.targets.forEach( ( description, i ) => {

				const name = attachmentName( description );
				const [ r, g, b, a ] = description.clear;

				if ( i % 4 === 0 ) columns = native( passText( model, pass, i, written, isGlsl ) )( straightColor(), distance(), span, pixel, ...texels( pass.reads ) ).toVar();

				node.outputNodes[ name ] = columns.element( i % 4 );
				node.setBlendMode( name, blendMode( description ) ).setClearColor( name, 0, a );
				node.getClearColor( name ).setRGB( r, g, b );

			} );

			const result = { target, node, shaded: isShaded( pass ), every: isSmall ? around.every : 1, afterCuts: isSmall && fromLast };

			if ( isSmall ) {

				if ( small.size === 0 ) {

					// Opaque objects hide here what they hide in the frame.
					const depthNode = textureLoad( depthTexture, ivec2( screenUV.mul( viewport.zw ).add( viewport.xy ) ) ).x;

					result.first = { target: renderTarget( [ around ], smallDepth ), quad: fullScreen( 'depth', { fragmentNode: vec4( 0 ), depthNode, depthTest: true, depthWrite: true, depthFunc: AlwaysDepth } ) };

				}

				pass.targets.forEach( ( { name }, i ) => small.set( name, target.textures[ i ] ) );

				if ( small.size === around.pass.targets.length ) {

					const names = around.pass.targets.map( ( { name } ) => name );

					result.then = this._around( model, native, isGlsl, 'sum', names, ( at ) => [ vec2( at ), ...names.map( ( name ) => textureLoad( small.get( name ), at ) ) ] );
					written.set( around.name, texture( result.then.target.texture, pixel.sub( viewport.xy ).div( viewport.zw ) ).level( 0 ) );

				}

			} else {

				pass.targets.forEach( ( { name }, i ) => {

					kept.set( name, target.textures[ i ] );
					written.set( name, textureLoad( target.textures[ i ], texel ) );

				} );

			}

			return result;

		} );

		this.next = null;

		if ( fromLast ) {

			const names = resolve_reads;
			const current = written.get( around.name );

			// The middles of tiles, and what the finished frame kept there.
			this.next = this._around( model, native, isGlsl, 'last', names, ( at ) => {

				const middle = vec2( at.mul( around.every ).add( around.every / 2 ) ).min( viewport.zw.sub( 1 ) ).add( viewport.xy ).toVar();
				const place = middle.add( 0.5 ).sub( viewport.xy ).div( viewport.zw );

				return [ middle.add( 0.5 ), ...names.map( ( name ) => name === around.name ? current.sample( place ).level( 0 ) : textureLoad( kept.get( name ), ivec2( middle ) ) ) ];

			} );
			this._current = current;

		}

		const resolved = native( resolveText( model, written, isGlsl ) )( pixel, ...texels( resolve_reads ) );

		this.over = over( resolved, outputs );
		this.coverage = coverage && { target: coverage, quad: fullScreen( 'coverage', { fragmentNode: vec4( resolved.aaaa ), transparent: true, ...TOGETHER } ) };
		this.surface = threshold && surface( textureLoad( coverage.texture, texel ).x, threshold, outputs );
		this._viewport = viewport.value;

	}

	// The pass that makes the small texture.
	_around( model, native, isGlsl, key, names, read ) {

		const sum = sumAround( read, native( sumText( model, key, names, isGlsl ) ) );

		return { target: renderTarget( [ model.description.around ], null, LinearFilter ), quad: fullScreen( `around ${ key }`, { fragmentNode: native( aroundText( model, isGlsl ) )( sum ) } ) };

	}

	/** What is drawn now reads the small texture that was made last. */
	swap() {

		const then = this.passes.findLast( ( pass ) => pass.then !== undefined ).then;

		[ then.target, this.next.target ] = [ this.next.target, then.target ];
		this._current.value = then.target.texture;

	}

	/** Takes size, viewport and scissor of the target of the opaque objects over. A small target has the viewport's. */
	setSize( { width, height, viewport, scissor, scissorTest } ) {

		this._viewport.copy( viewport );

		for ( const { first, target, every, then } of this.passes ) {

			if ( every > 1 ) {

				for ( const small of [ first?.target, target, then?.target, this.next?.target ] ) small?.setSize( Math.ceil( viewport.z / every ), Math.ceil( viewport.w / every ) );

				continue;

			}

			target.setSize( width, height );
			target.viewport.copy( viewport );
			target.scissor.copy( scissor );
			target.scissorTest = scissorTest;

		}

	}

	dispose() {

		for ( const { first, target, every, then } of this.passes ) {

			// The depth texture belongs to the opaque pass.
			if ( every === 1 ) target.depthTexture = null;

			for ( const made of [ target, first?.target, first?.quad.material, then?.target, then?.quad.material ] ) made?.dispose();

		}

		for ( const made of [ this.over.quad.material, this.coverage?.quad.material, this.next?.target, this.next?.quad.material ] ) made?.dispose();

	}

}
