// The pass that replaces three.js's sorted drawing of transparent objects by a learned, order-independent one.

import { Matrix4, NormalBlending, PassNode, RenderTarget, RendererUtils, Vector2, Vector3, Vector4 } from 'three/webgpu';
import { renderGroup, uniform } from 'three/tsl';
import { DepthRange, warped } from './depth-range.js';
import { blendAlike, deviceProblem, drawnPasses, watchDevice } from './device.js';
import { modelProblem } from './model.js';
import { releasePasses } from './release.js';
import { Stages } from './stages.js';

const _size = /*@__PURE__*/ new Vector2();
const _place = /*@__PURE__*/ new Vector3();
const _view = /*@__PURE__*/ new Vector3();

// What may move from frame to frame where the next one is made from the last: places, of a frame of 2, and depths, of a range of 2.
const MOVED = 0.0625;
const STRETCHED = 0.125;

let _rendererState;
let _sceneState;

const report = ( message ) => console.error( `@peelnet/three: ${ message }` );

/**
 * Whether a material is drawn by the learned weights. Others (additive, transmissive, …) are drawn with the opaque objects, sorted.
 */
export function isOrderIndependent( material ) {

	return material.transparent === true && material.blending === NormalBlending
		&& ! ( material.transmission > 0 ) && material.transmissionNode?.isNode !== true && material.backdropNode?.isNode !== true;

}

// Draws a full-screen quad between passes, whose settings it leaves.
function drawQuad( renderer, { target, quad } ) {

	const { opaque } = renderer;
	const draw = renderer.getRenderObjectFunction();

	renderer.setRenderObjectFunction( null );
	renderer.setMRT( null );
	renderer.setRenderTarget( target );
	renderer.opaque = true;
	quad.render( renderer );
	renderer.opaque = opaque;
	renderer.setRenderObjectFunction( draw );

}

/** A PassNode that draws a scene's transparent objects in any order. */
export class PeelnetPassNode extends PassNode {

	static get type() {

		return 'PeelnetPassNode';

	}

	constructor( scene, camera, { model, range = 'pixel', depthRange = null, onProblem = report, ...options } = {} ) {

		super( PassNode.COLOR, scene, camera, options );

		this.isPeelnetPassNode = true;

		/** `[near, far]` of z that replaces the range of the objects' boxes, for what a shader moves out of them. */
		this.depthRange = depthRange;

		/** Called once for each problem. The scene is then drawn as three.js draws it, sorted. */
		this.onProblem = onProblem;

		/** What keeps the model from being drawn, or null. */
		this.problem = null;

		this._model = model;
		this._range = range;
		this._span = uniform( new Vector4() ).setGroup( renderGroup );
		this._depths = new DepthRange();
		this._stages = null;
		this._stale = true;
		this._cleared = new Vector2( 0, 0 );
		this._renderer = null;
		this._viewFromWorld = null;
		this._unwatch = null;

		// The finished image. The target of the base class holds what lies below the transparent objects.
		this._finished = new RenderTarget( 1, 1, { depthBuffer: false, samples: 0 } );
		this._finished.texture.name = 'output';

		this._drawBelow = ( object, ...rest ) => this._drawOrKeep( object, rest );
		this._drawTransparent = ( object, ...rest ) => this._drawKept( object, rest );

	}

	/** The model that is drawn: `{ description, wgsl, glsl }`. May be set at any time. */
	get model() {

		return this._model;

	}

	set model( model ) {

		this._stale = this._stale || model !== this._model;
		this._model = model;

	}

	/** Where depths are told apart: among those seen around each pixel, at one more small pass, in the frame, or in the last one. */
	get range() {

		return this._range;

	}

	set range( range ) {

		this._stale = this._stale || range !== this._range;
		this._range = range;

	}

	setup( builder ) {

		super.setup( builder );

		this._finished.texture.type = builder.renderer.getOutputBufferType();

		return this.getTextureNode();

	}

	setSize( width, height ) {

		super.setSize( width, height );

		this._finished.setSize( this.renderTarget.width, this.renderTarget.height );
		this._stages?.setSize( this.renderTarget );

	}

	updateBefore( frame ) {

		const { renderer } = frame;

		this._prepare( renderer );

		_rendererState = RendererUtils.saveRendererState( renderer, _rendererState );

		// What lies below: opaque objects, and transparent ones that no weight can blend. The others are only noted.
		this._renderer = renderer;
		this._depths.reset();
		this._kept = 0;
		this._viewFromWorld = this.camera.matrixWorldInverse;
		renderer.setRenderObjectFunction( this._drawBelow );
		super.updateBefore( frame );

		const drawn = this._kept > 0;

		if ( drawn ) this._drawPasses( renderer );

		this._show( drawn ? this._finished.texture : this.renderTarget.texture );

		RendererUtils.restoreRendererState( renderer, _rendererState );
		this._renderer = null;

	}

	/** Builds the stages of a new model and clears targets of a new size, before anything of the frame is drawn. */
	_prepare( renderer ) {

		renderer.getDrawingBufferSize( _size );

		if ( this._stale ) this._build( renderer );

		this.setSize( _size.width, _size.height );

		const { width, height } = this.renderTarget;

		if ( this._stages === null || ( this._cleared.x === width && this._cleared.y === height ) ) return;

		// three.js clears the depth of a target that it has not seen before, at its first drawing. The targets share the opaque
		// objects' depth, so this must happen before those are drawn.
		const target = renderer.getRenderTarget();

		for ( const { renderTarget } of [ this, ...this._stages.passes.map( ( pass ) => ( { renderTarget: pass.target } ) ) ] ) {

			renderer.setRenderTarget( renderTarget );
			renderer.clear();

		}

		renderer.setRenderTarget( target );
		this._cleared.set( width, height );

	}

	_build( renderer ) {

		this._release( renderer );
		this._stale = false;
		this._unwatch ??= watchDevice( renderer, ( message ) => this._fail( message ) );
		this.problem = null;

		const problem = this._findProblem( renderer );

		if ( problem !== null ) return this._fail( problem );

		this._stages = new Stages( this._model, drawnPasses( renderer, this._model, this._range ), {
			isGlsl: renderer.backend.isWebGPUBackend !== true,
			depthTexture: this.renderTarget.depthTexture,
			below: this.renderTarget.texture,
			span: this._span,
			fromLast: this._range === 'last'
		} );
		this._seen = null;
		this._cleared.set( 0, 0 );
		this._built = renderer;

	}

	_findProblem( renderer ) {

		if ( [ 'pixel', 'frame', 'last' ].includes( this._range ) === false ) return 'The option range is neither "pixel" nor "frame" nor "last".';

		const problem = modelProblem( this._model );

		if ( problem !== null ) return problem;

		if ( this._range === 'last' && this._model.description.around?.last === undefined ) return `The recipe "${ this._model.description.recipe }" does not read what the last frame shows: set the range to "pixel" or "frame".`;

		if ( this.renderTarget.samples > 1 ) return `Multisampling is not supported: a model's statistics must not be averaged over the ${ this.renderTarget.samples } samples of a pixel. Pass { samples: 0 }, and smooth edges afterwards, for example with fxaa().`;

		if ( this.renderTarget.depthTexture === null ) return 'The pass needs a depth buffer: leave out { depthBuffer: false }.';

		if ( renderer.xr.isPresenting === true ) return 'XR is not supported.';

		return deviceProblem( renderer, this._model, this._range );

	}

	_fail( message ) {

		this.problem = message;
		this.onProblem( message );

	}

	_drawOrKeep( object, rest ) {

		const material = rest[ 3 ];

		if ( this._stages !== null && isOrderIndependent( material ) ) {

			this._kept ++;
			this._depths.add( object, this._viewFromWorld );

		} else {

			this._renderer.renderObject( object, ...rest );

		}

	}

	_drawKept( object, rest ) {

		const material = rest[ 3 ];

		if ( isOrderIndependent( material ) === false ) return;

		const { depthWrite, forceSinglePass } = material;

		// No fragment hides another, and the sides of a surface need no order: one draw is enough for both.
		material.depthWrite = false;
		material.forceSinglePass = true;

		this._renderer.renderObject( object, ...rest );

		material.depthWrite = depthWrite;
		material.forceSinglePass = forceSinglePass;

	}

	_drawPasses( renderer ) {

		const { scene, camera } = this;
		const { mask } = camera.layers;
		const { sortObjects, contextNode, lighting: rendererLighting } = renderer;
		const lighting = this.lighting ?? rendererLighting;
		const isLit = lighting.enabled;
		const endBlending = blendAlike( renderer );

		if ( this._layers !== null ) camera.layers.mask = this._layers.mask;
		if ( this.contextNode !== null ) renderer.contextNode = this._getContextNode( renderer );

		this._writeSpan();
		_sceneState = RendererUtils.resetSceneState( scene, _sceneState );
		renderer.lighting = lighting;

		renderer.setRenderObjectFunction( this._drawTransparent );
		renderer.autoClear = renderer.autoClearColor = true;
		renderer.autoClearDepth = renderer.autoClearStencil = false;
		renderer.opaque = renderer.sortObjects = false;
		renderer.transparent = true;

		const { passes, next, quad } = this._stages;
		const isCut = next === null || this._isCut();

		for ( const { first, target, node, shaded, afterCuts, then } of passes ) {

			if ( afterCuts && isCut === false ) continue;
			if ( first !== undefined ) drawQuad( renderer, first );

			// Passes without colour need no light.
			lighting.enabled = isLit && shaded;
			renderer.setRenderTarget( target );
			renderer.setMRT( node );
			renderer.render( scene, camera );

			if ( then !== undefined ) drawQuad( renderer, then );

		}

		endBlending();

		lighting.enabled = isLit;
		renderer.lighting = rendererLighting;
		renderer.sortObjects = sortObjects;
		renderer.contextNode = contextNode;
		RendererUtils.restoreSceneState( scene, _sceneState );
		camera.layers.mask = mask;

		drawQuad( renderer, { target: this._finished, quad } );

		if ( next === null ) return;

		drawQuad( renderer, next );
		this._stages.swap();

	}

	/** Whether so much moved since the last frame that this one learns nothing from it: places by a thirty-second of the frame, or depths by a bin. */
	_isCut() {

		const { camera, _span: { value: span } } = this;
		const clipFromWorld = new Matrix4().multiplyMatrices( camera.projectionMatrix, camera.matrixWorldInverse );
		const last = this._seen;

		this._seen = { clipFromWorld, worldFromClip: clipFromWorld.clone().invert(), span: span.clone() };

		if ( last === null ) return true;

		const isApart = ( [ x, y, z ] ) => {

			const place = _place.set( x, y, z ).applyMatrix4( last.worldFromClip );
			const depth = - _view.copy( place ).applyMatrix4( camera.matrixWorldInverse ).z;

			place.applyMatrix4( clipFromWorld );

			return ! ( Math.hypot( place.x - x, place.y - y ) < MOVED && Math.abs( warped( depth, span ) - warped( depth, last.span ) ) < STRETCHED );

		};

		return [ - 1, 1 ].some( ( x ) => [ - 1, 1 ].some( ( y ) => [ 0.5, 0.99 ].some( ( z ) => isApart( [ x, y, z ] ) ) ) );

	}

	_writeSpan() {

		if ( this.depthRange !== null ) [ this._depths.near, this._depths.far ] = this.depthRange;

		this._depths.write( this.camera, this._span.value );

	}

	/** Which texture the pass's node shows. */
	_show( texture ) {

		if ( this._textures.output === texture ) return;

		this._textures.output = texture;
		this._textureNodes.output?.updateTexture();

	}

	_release( renderer ) {

		if ( this._stages === null ) return;

		releasePasses( renderer, new Set( this._stages.passes.map( ( pass ) => pass.node ) ) );
		this._stages.dispose();
		this._stages = null;

	}

	dispose() {

		if ( this._stages !== null ) this._release( this._built );

		this._unwatch?.();
		this._finished.dispose();
		super.dispose();

	}

}

/**
 * A pass that draws a scene with learned order-independent transparency.
 *
 * @param {import('three/webgpu').Scene} scene
 * @param {import('three/webgpu').Camera} camera
 * @param {object} options - `model`, and optionally `range`, `depthRange`, `onProblem`, and what `pass()` of three.js takes
 */
export const peelnetPass = ( scene, camera, options ) => new PeelnetPassNode( scene, camera, options );
