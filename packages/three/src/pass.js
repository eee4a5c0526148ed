// The pass that replaces three.js's sorted drawing of transparent objects by a learned, order-independent one.

import { AdditiveBlending, Color, HalfFloatType, Matrix4, NormalBlending, PassNode, RedFormat, RenderTarget, RendererUtils, Vector2, Vector3, Vector4 } from 'three/webgpu';
import { passTexture, renderGroup, uniform } from 'three/tsl';
import { DepthRange, warped } from './depth-range.js';
import { deviceProblem, drawnPasses, watchDevice } from './device.js';
import { drawQuad } from './full-screen.js';
import { modelProblem } from './model.js';
import { blendAlike, contextOf, drawAgain, leaveOutBundles, releasePasses } from './private.js';
import { Samples, isCount } from './samples.js';
import { Stages } from './stages.js';

const _size = /*@__PURE__*/ new Vector2();
const _place = /*@__PURE__*/ new Vector3();
const _view = /*@__PURE__*/ new Vector3();
const _color = /*@__PURE__*/ new Color();

// What may move from frame to frame where the next one is made from the last: places, of a frame of 2, and depths, of a range of 2.
const MOVED = 0.0625;
const STRETCHED = 0.125;

let _rendererState;
let _sceneState;

const report = ( message ) => console.error( `@peelnet/three: ${ message }` );

const isNode = ( value ) => value?.isNode === true;

// Light that adds to what is seen, and what ignores depth, such as labels and gizmos: drawn after all others, sorted.
const isOver = ( material ) => material.transparent === true && ( material.depthTest === false || material.blending === AdditiveBlending );

// What shows what lies behind it, bent or blurred.
const isLens = ( material ) => material.transmission > 0 || isNode( material.transmissionNode ) || isNode( material.backdropNode );

/**
 * Whether a material is drawn by the learned weights. Others are drawn as three.js draws them: additive ones and those that ignore depth after
 * it, transmissive ones in their places among the objects, the rest (with a fragment or a depth of their own, …) with the opaque objects.
 */
export function isOrderIndependent( material ) {

	return material.transparent === true && material.blending === NormalBlending && material.depthTest !== false && isLens( material ) === false
		&& isNode( material.fragmentNode ) === false && isNode( material.depthNode ) === false;

}

/** The default of the option `filter`: whether neither an object's nor its material's `userData.peelnet` is false. */
export const isWanted = ( object, material ) => object.userData.peelnet !== false && material.userData.peelnet !== false;

// The cameras that a frame is drawn with: the eyes of XR, or of an array.
const eyesOf = ( camera ) => camera.isArrayCamera === true && camera.cameras.length > 0 ? camera.cameras : [ camera ];

/** A PassNode that draws a scene's transparent objects in any order. */
export class PeelnetPassNode extends PassNode {

	static get type() {

		return 'PeelnetPassNode';

	}

	constructor( scene, camera, { model, range = 'pixel', depthRange = null, depthThreshold = null, samples = 0, filter = isWanted, onProblem = report, ...options } = {} ) {

		// Statistics must not be averaged over the samples of a pixel: each is drawn by itself.
		super( PassNode.COLOR, scene, camera, { ...options, samples: 0 } );

		this.isPeelnetPassNode = true;

		/** `[near, far]` of z that replaces the range of the objects' boxes, for what a shader moves out of them. */
		this.depthRange = depthRange;

		/**
		 * Coverage from which on the nearest fragment of a pixel writes its depth, and what the other outputs are of it, such as normals; null for none.
		 */
		this.depthThreshold = depthThreshold;

		/** How many drawings of the scene a frame is the mean of, at as many places in the pixel: an even number, or 0 for one in the middle. */
		this.samples = samples;

		/** Whether an object of a material is drawn by the learned weights, where `isOrderIndependent` says that it can be; else it is drawn after them. */
		this.filter = filter;

		/** Called once for each problem. The scene is then drawn as three.js draws it, sorted. */
		this.onProblem = onProblem;

		/** What keeps the model from being drawn, or null. */
		this.problem = null;

		this._model = model;
		this._range = range;
		this._span = uniform( new Vector4() ).setGroup( renderGroup );
		this._threshold = uniform( 0 ).setGroup( renderGroup );
		this._depths = new DepthRange();
		this._listed = new Set();
		// Objects of the frame that are drawn by the weights, and lenses over them, far ones first.
		this._rounds = [];
		this._stages = null;
		this._samples = null;
		this._coverage = null;
		this._stale = true;
		this._wanted = [];
		this._cleared = new Vector2( 0, 0 );
		this._renderer = null;
		this._viewed = camera;
		this._unwatch = null;

		this._drawBelow = ( object, ...rest ) => this._drawOrKeep( object, rest );
		this._drawTransparent = ( object, ...rest ) => this._round.kept.has( object ) && this._drawKept( object, rest, false );
		this._drawLens = ( object, ...rest ) => this._round.lenses.has( object ) && isLens( rest[ 3 ] ) && this._drawPlain( object, rest );
		this._drawNearest = ( object, ...rest ) => this._drawKept( object, rest, true );
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

	/** How much of each pixel is covered, 0 to 1, by what the learned weights draw: a mask for what comes after. */
	getCoverageNode() {

		this._useCoverage();

		return passTexture( this, this._coverage.texture );

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

		this._coverage?.setSize( this.renderTarget.width, this.renderTarget.height );
		this._stages?.setSize( this.renderTarget );

	}

	updateBefore( frame ) {

		const { renderer } = frame;

		// A bundle draws what it recorded, which may be of another pass.
		const endBundles = leaveOutBundles( renderer );

		this._prepare( renderer );

		_rendererState = RendererUtils.saveRendererState( renderer, _rendererState );
		this._renderer = renderer;

		const draw = () => this._drawFrame( frame );

		if ( this._samples === null || this._viewed.isArrayCamera === true ) draw();
		else this._samples.draw( renderer, this._viewed, this.renderTarget, ( i ) => i === 0 ? draw() : drawAgain( this, draw ) );

		RendererUtils.restoreRendererState( renderer, _rendererState );
		this._renderer = null;
		endBundles();

	}

	_drawFrame( frame ) {

		const { renderer } = frame;

		// What lies below: opaque objects, and transparent ones that no weight can blend. The others are only noted.
		this._depths.reset();
		this._listed.clear();
		this._rounds.length = this._over = 0;
		renderer.setRenderObjectFunction( this._drawBelow );
		super.updateBefore( frame );

		if ( this._coverage !== null ) this._clearCoverage( renderer );

		if ( this._rounds.length + this._over > 0 ) this._drawTransparents( renderer );

	}

	/** Builds the stages of a new model and clears targets of a new size, before anything of the frame is drawn. */
	_prepare( renderer ) {

		// As PassNode finds them.
		const output = renderer.getOutputRenderTarget();
		const isXR = output?.isXRRenderTarget === true;

		if ( isXR ) _size.set( output.width, output.height );
		else renderer.getDrawingBufferSize( _size );

		this._viewed = isXR ? renderer.xr.getCamera() : this.camera;

		if ( this.depthThreshold !== null ) this._useCoverage();

		// What may change at any time: a session may start, outputs be added.
		const wanted = [ this._viewed.isMultiViewCamera === true, this.getMRT(), this.samples, this.depthThreshold === null, this._coverage ];

		if ( this._stale || wanted.some( ( value, i ) => value !== this._wanted[ i ] ) ) {

			this._wanted = wanted;
			this._build( renderer );

		}

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
			span: this._span,
			outputs: this.getMRT(),
			fromLast: this._range === 'last',
			coverage: this._coverage,
			threshold: this.depthThreshold === null ? null : this._threshold
		} );
		this._samples = this.samples <= 1 ? null : new Samples( this.samples, renderer.getOutputBufferType(), this.getMRT() );
		this._seen = null;
		this._cleared.set( 0, 0 );
		this._built = renderer;

	}

	_findProblem( renderer ) {

		if ( [ 'pixel', 'frame', 'last' ].includes( this._range ) === false ) return 'The option range is neither "pixel" nor "frame" nor "last".';

		const problem = modelProblem( this._model );

		if ( problem !== null ) return problem;

		if ( this._range === 'last' && this._model.description.around?.last === undefined ) return `The recipe "${ this._model.description.recipe }" does not read what the last frame shows: set the range to "pixel" or "frame".`;

		if ( isCount( this.samples ) === false ) return `The option samples is ${ Number( this.samples ) }, and must be 0, 1 or an even number up to 16.`;

		if ( this.renderTarget.depthTexture === null ) return 'The pass needs a depth buffer: leave out { depthBuffer: false }.';

		if ( this.getMRT() !== null && renderer.backend.isWebGPUBackend !== true && ! renderer.backend.drawBuffersIndexedExt ) return 'This device cannot blend over one of several outputs: WebGL 2 needs the extension OES_draw_buffers_indexed.';

		if ( this._viewed.isMultiViewCamera === true ) return 'Both eyes at once are not supported: leave out { multiview: true } of the renderer, and each eye is drawn by itself. Until then, what is transparent is drawn sorted.';

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

			// Objects come from far to near: what follows a lens is drawn over it.
			if ( this._rounds.length === 0 || this._rounds.at( - 1 ).lenses.size > 0 ) this._rounds.push( { kept: new Set(), lenses: new Set() } );

			this._rounds.at( - 1 ).kept.add( object );

			if ( this.depthRange === null ) for ( const eye of eyesOf( this._viewed ) ) this._depths.add( object, eye.matrixWorldInverse );

		} else if ( this._isOver( object, material ) ) {

			this._over ++;

		} else if ( isLens( material ) && this._rounds.length > 0 ) {

			this._rounds.at( - 1 ).lenses.add( object );

		} else {

			this._drawPlain( object, rest );

		}

	}

	_drawPlain( object, rest ) {

		const material = rest[ 3 ];
		const { depthWrite } = material;

		// Glass behind it is not hidden by what can be seen through.
		if ( material.transparent === true ) material.depthWrite = false;

		this._renderer.renderObject( object, ...rest );
		material.depthWrite = depthWrite;

	}

	_isKept( object, material ) {

		return isOrderIndependent( material ) && this.filter( object, material );

	}

	_isOver( object, material ) {

		return isOver( material ) || ( material.transparent === true && this.filter( object, material ) === false );

	}

	_drawKept( object, rest, isWriting ) {

		const material = rest[ 3 ];

		if ( this._isKept( object, material ) === false ) return;

		const { depthWrite, forceSinglePass } = material;

		// Only the nearest surface hides others, and the sides of a surface need no order: one draw is enough for both.
		material.depthWrite = isWriting;
		material.forceSinglePass = true;

		// A batch lists its instances once for all passes, in no order, in which equal ones are drawn at once.
		const { sortObjects, perObjectFrustumCulled } = object;

		if ( object.isBatchedMesh === true ) {

			object.sortObjects = false;
			object.perObjectFrustumCulled = perObjectFrustumCulled && this._listed.has( object ) === false;
			this._listed.add( object );

		}

		this._renderer.renderObject( object, ...rest );

		if ( object.isBatchedMesh === true ) Object.assign( object, { sortObjects, perObjectFrustumCulled } );

		material.depthWrite = depthWrite;
		material.forceSinglePass = forceSinglePass;

	}

	/** Draws what is kept, and over it what lies over all, with what `pass()` draws the scene with. */
	_drawTransparents( renderer ) {

		const { scene, _viewed: camera } = this;
		const { mask } = camera.layers;
		const { sortObjects, contextNode, lighting: rendererLighting } = renderer;
		const lighting = this.lighting ?? rendererLighting;
		const isLit = lighting.enabled;

		renderer.contextNode = contextOf( this, renderer );
		camera.layers.mask = this.getLayers()?.mask ?? mask;

		_sceneState = RendererUtils.resetSceneState( scene, _sceneState );
		scene.overrideMaterial = this.overrideMaterial ?? _sceneState.overrideMaterial;
		renderer.lighting = lighting;
		renderer.opaque = false;
		renderer.transparent = true;

		const drawSorted = ( draw ) => {

			renderer.setRenderObjectFunction( draw );
			renderer.autoClear = false;
			renderer.sortObjects = sortObjects;
			renderer.setRenderTarget( this.renderTarget );
			renderer.setMRT( this.getMRT() );
			renderer.render( scene, camera );

		};

		if ( this._rounds.length > 0 ) this._writeSpan();

		for ( this._round of this._rounds ) {

			this._drawPasses( renderer, lighting, isLit );

			if ( this._round.lenses.size > 0 ) drawSorted( this._drawLens );

		}

		if ( this._over > 0 ) drawSorted( this._drawOver );
		if ( this._rounds.length > 0 && this.depthThreshold !== null ) this._drawSurface( renderer );

		renderer.lighting = rendererLighting;
		renderer.sortObjects = sortObjects;
		renderer.contextNode = contextNode;
		RendererUtils.restoreSceneState( scene, _sceneState );
		camera.layers.mask = mask;

	}

	_drawPasses( renderer, lighting, isLit ) {

		const { passes, next, over, coverage } = this._stages;
		const endBlending = blendAlike( renderer );

		// What the last frame shows is of all its objects.
		const isWhole = next !== null && this._rounds.length === 1;
		const isCut = isWhole === false || this._isCut();

		renderer.setRenderObjectFunction( this._drawTransparent );
		renderer.autoClear = renderer.autoClearColor = true;
		renderer.autoClearDepth = renderer.autoClearStencil = renderer.sortObjects = false;

		for ( const { first, target, node, shaded, every, afterCuts, then } of passes ) {

			if ( afterCuts && isCut === false ) continue;
			if ( first !== undefined ) drawQuad( renderer, first );

			// Passes without colour need no light.
			lighting.enabled = isLit && shaded;
			renderer.setRenderTarget( target );
			renderer.setMRT( node );
			this._drawScene( renderer, every );

			if ( then !== undefined ) drawQuad( renderer, then );

		}

		lighting.enabled = isLit;
		endBlending();

		drawQuad( renderer, { ...over, target: this.renderTarget } );

		if ( coverage !== null ) drawQuad( renderer, coverage );
		if ( isWhole === false ) return;

		drawQuad( renderer, next );
		this._stages.swap();

	}

	/** Draws the scene into a target that is so many times smaller. The eyes of an array have places in it. */
	_drawScene( renderer, every ) {

		const { _viewed: camera } = this;
		const viewports = every === 1 ? [] : eyesOf( camera ).map( ( eye ) => eye.viewport ).filter( ( viewport ) => viewport !== undefined );

		for ( const viewport of viewports ) viewport.divideScalar( every );

		renderer.render( this.scene, camera );

		for ( const viewport of viewports ) viewport.multiplyScalar( every );

	}

	_drawSurface( renderer ) {

		const endBlending = blendAlike( renderer );

		this._threshold.value = this.depthThreshold;
		renderer.setRenderObjectFunction( this._drawNearest );
		renderer.autoClear = renderer.sortObjects = false;
		renderer.setRenderTarget( this.renderTarget );
		renderer.setMRT( this._stages.surface );
		renderer.render( this.scene, this._viewed );
		endBlending();

	}

	_useCoverage() {

		this._coverage ??= new RenderTarget( 1, 1, { type: HalfFloatType, format: RedFormat, depthBuffer: false, samples: 0 } );

	}

	_clearCoverage( renderer ) {

		const alpha = renderer.getClearAlpha();
		const { r, g, b } = renderer.getClearColor( _color );

		renderer.setClearColor( 0x000000, 0 );
		renderer.setRenderTarget( this._coverage );
		renderer.setMRT( null );
		renderer.clear();
		renderer.setClearColor( _color.setRGB( r, g, b ), alpha );

	}

	/** Whether so much moved since the last frame that this one learns nothing from it: places by a thirty-second of the frame, or depths by a bin. */
	_isCut() {

		const { camera, _span: { value: span } } = this;

		// Eyes are not followed.
		if ( this._viewed !== camera || camera.isArrayCamera === true ) return true;

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

		this._depths.write( eyesOf( this._viewed ), this._span.value );

	}

	_release( renderer ) {

		if ( this._stages === null ) return;

		const { passes, surface } = this._stages;

		releasePasses( renderer, new Set( [ ...passes.map( ( pass ) => pass.node ), ...surface === null ? [] : [ surface ] ] ) );
		this._stages.dispose();
		this._samples?.dispose();
		this._stages = this._samples = null;

	}

	dispose() {

		if ( this._stages !== null ) this._release( this._built );

		this._coverage?.dispose();
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
