// The pass that replaces three.js's sorted drawing of transparent objects by a learned, order-independent one.

import { AdditiveBlending, Matrix4, NormalBlending, PassNode, RendererUtils, Vector2, Vector3, Vector4 } from 'three/webgpu';
import { renderGroup, uniform } from 'three/tsl';
import { DepthRange, warped } from './depth-range.js';
import { blendAlike, deviceProblem, drawnPasses, leaveOutBundles, watchDevice } from './device.js';
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

const isNode = ( value ) => value?.isNode === true;

// Light that adds to what is seen, and what ignores depth, such as labels and gizmos: drawn after all others, sorted.
const isOver = ( material ) => material.transparent === true && ( material.depthTest === false || material.blending === AdditiveBlending );

/**
 * Whether a material is drawn by the learned weights. Others are drawn as three.js draws them: additive ones and those that ignore depth after
 * it, the rest (transmissive, with a fragment or a depth of their own, …) with the opaque objects.
 */
export function isOrderIndependent( material ) {

	return material.transparent === true && material.blending === NormalBlending && material.depthTest !== false
		&& ! ( material.transmission > 0 ) && ! [ 'transmissionNode', 'backdropNode', 'fragmentNode', 'depthNode' ].some( ( name ) => isNode( material[ name ] ) );

}

/** The default of the option `filter`: whether neither an object's nor its material's `userData.peelnet` is false. */
export const isWanted = ( object, material ) => object.userData.peelnet !== false && material.userData.peelnet !== false;

// Draws a full-screen quad between passes, whose settings it leaves.
function drawQuad( renderer, { target, quad, node = null } ) {

	const { opaque } = renderer;
	const draw = renderer.getRenderObjectFunction();

	renderer.setRenderObjectFunction( null );
	renderer.setMRT( node );
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

	constructor( scene, camera, { model, range = 'pixel', depthRange = null, filter = isWanted, onProblem = report, ...options } = {} ) {

		// A renderer with multisampling draws it, too: statistics of a pixel have no samples.
		super( PassNode.COLOR, scene, camera, { samples: 0, ...options } );

		this.isPeelnetPassNode = true;

		/** `[near, far]` of z that replaces the range of the objects' boxes, for what a shader moves out of them. */
		this.depthRange = depthRange;

		/** Whether an object of a material is drawn by the learned weights, where `isOrderIndependent` says that it can be; else it is drawn after them. */
		this.filter = filter;

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

		this._drawBelow = ( object, ...rest ) => this._drawOrKeep( object, rest );
		this._drawTransparent = ( object, ...rest ) => this._drawKept( object, rest );
		this._drawOver = ( object, ...rest ) => this._isOver( object, rest[ 3 ] ) && this._renderer.renderObject( object, ...rest );

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

	/** Compiles what the pass draws, by drawing a frame of it. */
	async compileAsync( renderer ) {

		await super.compileAsync( renderer );

		this.renderTarget.texture.type = renderer.getOutputBufferType();
		this.updateBefore( { renderer } );

		await renderer.backend.device?.queue.onSubmittedWorkDone();

	}

	setSize( width, height ) {

		super.setSize( width, height );

		this._stages?.setSize( this.renderTarget );

	}

	updateBefore( frame ) {

		const { renderer } = frame;

		// A bundle draws what it recorded, which may be of another pass.
		const endBundles = leaveOutBundles( renderer );

		this._prepare( renderer );

		_rendererState = RendererUtils.saveRendererState( renderer, _rendererState );

		// What lies below: opaque objects, and transparent ones that no weight can blend. The others are only noted.
		this._renderer = renderer;
		this._depths.reset();
		this._kept = this._over = 0;
		this._viewFromWorld = this.camera.matrixWorldInverse;
		renderer.setRenderObjectFunction( this._drawBelow );
		super.updateBefore( frame );

		if ( this._kept + this._over > 0 ) this._drawTransparents( renderer );

		RendererUtils.restoreRendererState( renderer, _rendererState );
		this._renderer = null;
		endBundles();

	}

	/** Builds the stages of a new model and clears targets of a new size, before anything of the frame is drawn. */
	_prepare( renderer ) {

		renderer.getDrawingBufferSize( _size );

		// A session may start and end at any time, and outputs may be added.
		if ( this._isXR !== renderer.xr.isPresenting || this._outputs !== this._mrt ) this._stale = true;
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
		this._isXR = renderer.xr.isPresenting;
		this._outputs = this._mrt;
		this._unwatch ??= watchDevice( renderer, ( message ) => this._fail( message ) );
		this.problem = null;

		const problem = this._findProblem( renderer );

		if ( problem !== null ) return this._fail( problem );

		this._stages = new Stages( this._model, drawnPasses( renderer, this._model, this._range ), {
			isGlsl: renderer.backend.isWebGPUBackend !== true,
			depthTexture: this.renderTarget.depthTexture,
			span: this._span,
			outputs: this._outputs,
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

		if ( this.renderTarget.samples > 1 ) return `Multisampling is not supported: a model's statistics must not be averaged over the ${ this.renderTarget.samples } samples of a pixel. Leave out { samples }, and smooth edges afterwards, for example with fxaa().`;

		if ( this.renderTarget.depthTexture === null ) return 'The pass needs a depth buffer: leave out { depthBuffer: false }.';

		if ( this._outputs !== null && renderer.backend.isWebGPUBackend !== true && ! renderer.backend.drawBuffersIndexedExt ) return 'This device cannot blend over one of several outputs: WebGL 2 needs the extension OES_draw_buffers_indexed.';

		if ( renderer.xr.isPresenting === true ) return 'XR is not supported: what is transparent is drawn sorted while a session lasts.';

		return deviceProblem( renderer, this._model, this._range );

	}

	_fail( message ) {

		this.problem = message;
		this.onProblem( message );

	}

	_drawOrKeep( object, rest ) {

		const material = rest[ 3 ];

		if ( this._stages === null ) return this._renderer.renderObject( object, ...rest );

		if ( this._isKept( object, material ) ) {

			this._kept ++;

			if ( this.depthRange === null ) this._depths.add( object, this._viewFromWorld );

		} else if ( this._isOver( object, material ) ) {

			this._over ++;

		} else {

			const { depthWrite } = material;

			// Glass behind it is not hidden by what can be seen through.
			if ( material.transparent === true ) material.depthWrite = false;

			this._renderer.renderObject( object, ...rest );
			material.depthWrite = depthWrite;

		}

	}

	_isKept( object, material ) {

		return isOrderIndependent( material ) && this.filter( object, material );

	}

	_isOver( object, material ) {

		return isOver( material ) || ( material.transparent === true && this.filter( object, material ) === false );

	}

	_drawKept( object, rest ) {

		const material = rest[ 3 ];

		if ( this._isKept( object, material ) === false ) return;

		const { depthWrite, forceSinglePass } = material;

		// No fragment hides another, and the sides of a surface need no order: one draw is enough for both.
		material.depthWrite = false;
		material.forceSinglePass = true;

		this._renderer.renderObject( object, ...rest );

		material.depthWrite = depthWrite;
		material.forceSinglePass = forceSinglePass;

	}

	/** Draws what is kept, and over it what lies over all, with what `pass()` draws the scene with. */
	_drawTransparents( renderer ) {

		const { scene, camera } = this;
		const { mask } = camera.layers;
		const { sortObjects, contextNode, lighting: rendererLighting } = renderer;
		const lighting = this.lighting ?? rendererLighting;
		const isLit = lighting.enabled;

		if ( this._layers !== null ) camera.layers.mask = this._layers.mask;
		if ( this.contextNode !== null ) renderer.contextNode = this._getContextNode( renderer );

		_sceneState = RendererUtils.resetSceneState( scene, _sceneState );
		scene.overrideMaterial = this.overrideMaterial ?? _sceneState.overrideMaterial;
		renderer.lighting = lighting;
		renderer.opaque = false;
		renderer.transparent = true;

		if ( this._kept > 0 ) this._drawPasses( renderer, lighting, isLit );

		if ( this._over > 0 ) {

			renderer.setRenderObjectFunction( this._drawOver );
			renderer.autoClear = false;
			renderer.sortObjects = sortObjects;
			renderer.setRenderTarget( this.renderTarget );
			renderer.setMRT( this._mrt );
			renderer.render( scene, camera );

		}

		renderer.lighting = rendererLighting;
		renderer.sortObjects = sortObjects;
		renderer.contextNode = contextNode;
		RendererUtils.restoreSceneState( scene, _sceneState );
		camera.layers.mask = mask;

	}

	_drawPasses( renderer, lighting, isLit ) {

		const { passes, next, over } = this._stages;
		const endBlending = blendAlike( renderer );

		this._writeSpan();

		const isCut = next === null || this._isCut();

		renderer.setRenderObjectFunction( this._drawTransparent );
		renderer.autoClear = renderer.autoClearColor = true;
		renderer.autoClearDepth = renderer.autoClearStencil = renderer.sortObjects = false;

		for ( const { first, target, node, shaded, afterCuts, then } of passes ) {

			if ( afterCuts && isCut === false ) continue;
			if ( first !== undefined ) drawQuad( renderer, first );

			// Passes without colour need no light.
			lighting.enabled = isLit && shaded;
			renderer.setRenderTarget( target );
			renderer.setMRT( node );
			renderer.render( this.scene, this.camera );

			if ( then !== undefined ) drawQuad( renderer, then );

		}

		lighting.enabled = isLit;
		endBlending();

		renderer.autoClear = false;
		drawQuad( renderer, { ...over, target: this.renderTarget } );
		renderer.autoClear = true;

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

	_release( renderer ) {

		if ( this._stages === null ) return;

		releasePasses( renderer, new Set( this._stages.passes.map( ( pass ) => pass.node ) ) );
		this._stages.dispose();
		this._stages = null;

	}

	dispose() {

		if ( this._stages !== null ) this._release( this._built );

		this._unwatch?.();
		// Who draws it again, as hot reloading does, gets it again.
		this._unwatch = null;
		this._stale = true;
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
