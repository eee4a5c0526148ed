import type { Camera, Material, Object3D, PassNode, PassNodeOptions, Scene, TextureNode } from 'three/webgpu';

/** How a target blends: `dst + src`, `max(dst, src)` or `dst * (1 - src)`. */
export type PeelnetBlend = 'add' | 'max' | 'transmit';

export interface PeelnetTarget {
	name: string;
	/** WebGPU's name of the format. */
	format: string;
	clear: readonly number[];
	/** Blending of red, green and blue. */
	color: PeelnetBlend | ( string & {} );
	/** Blending of alpha. */
	alpha: PeelnetBlend | ( string & {} );
	/** What each fragment writes. */
	write: string;
}

/** A pass that draws all transparent surfaces, in any order. */
export interface PeelnetPassDescription {
	name: string;
	/** Targets of earlier passes, and the small texture, that it reads. */
	reads: readonly string[];
	/** What each fragment computes first. */
	compute: string;
	targets: readonly PeelnetTarget[];
}

/** A small texture of what surrounds each pixel, drawn before the passes that read it. */
export interface PeelnetAround {
	name: string;
	format: string;
	/** One texel for so many pixels of the frame, across and down. */
	every: number;
	/** Drawn at its size. */
	pass: PeelnetPassDescription;
	/** Summed over the 3 × 3 texels around each. */
	sum: string;
	/** A texel's value, of that sum. */
	write: string;
	/** Stands for it where it is not drawn. */
	last?: string;
	otherwise: string;
}

/** The content of an exported `model.json`. */
export interface PeelnetDescription {
	format: string;
	format_version: number;
	tool_version: string;
	recipe: string;
	parameters: number;
	topology: string;
	around?: PeelnetAround;
	passes: readonly PeelnetPassDescription[];
	resolve: string;
	resolve_reads: readonly string[];
}

/** A model: data that may be loaded, replaced and shared between passes. */
export interface PeelnetModel {
	description: PeelnetDescription;
	wgsl: string;
	/** GLSL ES 3.00, for the WebGL 2 back end. */
	glsl?: string | null;
}

export interface PeelnetPassOptions extends PassNodeOptions {
	model: PeelnetModel;
	/**
	 * Where depths are told apart: among those seen around each pixel, at one more pass of an eighth of the width and height (the default), in
	 * the frame's range, or, for `one`, where the last frame's pixels show what is seen.
	 */
	range?: 'pixel' | 'frame' | 'last';
	/** `[near, far]` of the distance along the view axis. The default is the range of the transparent objects' boxes in view. */
	depthRange?: readonly [ number, number ] | null;
	/** Whether an object of a material that can be drawn by the learned weights is; else it is drawn after them, sorted. The default is `isWanted`. */
	filter?: ( object: Object3D, material: Material ) => boolean;
	/** Called once for each problem; the scene is then drawn sorted. The default writes to the console. */
	onProblem?: ( message: string ) => void;
	/**
	 * Coverage, 0 to 1, from which on the nearest transparent surface of a pixel writes its depth, for depth of field and the like, and all outputs of
	 * `setMRT` but the image, such as normals and velocities. Null, the default, leaves them to opaque objects.
	 */
	depthThreshold?: number | null;
	/**
	 * How many drawings of the scene a frame is the mean of, each at another place in the pixel: what multisampling shows, with statistics and weights by
	 * sample. An even number up to 16; 0, the default, is one drawing.
	 */
	samples?: number;
}

/** A PassNode that draws a scene's transparent objects in any order. */
export class PeelnetPassNode extends PassNode {

	constructor( scene: Scene, camera: Camera, options: PeelnetPassOptions );

	readonly isPeelnetPassNode: true;
	/** The model that is drawn. May be set at any time. */
	model: PeelnetModel;
	/** May be set at any time. */
	range: 'pixel' | 'frame' | 'last';
	depthRange: readonly [ number, number ] | null;
	depthThreshold: number | null;
	samples: number;
	filter: ( object: Object3D, material: Material ) => boolean;
	onProblem: ( message: string ) => void;
	/** How much of each pixel is covered, 0 to 1, by what the learned weights draw: a mask for denoisers and temporal antialiasing. */
	getCoverageNode(): TextureNode;
	/** What keeps the model from being drawn, or null. */
	readonly problem: string | null;

}

/** A pass that draws a scene with learned order-independent transparency. */
export function peelnetPass( scene: Scene, camera: Camera, options: PeelnetPassOptions ): PeelnetPassNode;

/**
 * Whether a material can be drawn by the learned weights. Others are drawn as three.js draws them: additive ones and those that ignore depth after
 * it, transmissive ones in their places among the objects, the rest with the opaque objects.
 */
export function isOrderIndependent( material: Material ): boolean;

/** Whether neither an object's nor its material's `userData.peelnet` is false. */
export function isWanted( object: Object3D, material: Material ): boolean;

/** The version of `PeelnetDescription` that this package reads. */
export const FORMAT_VERSION: 1;

/** Loads an exported model, `<url>.json`, `<url>.wgsl` and, where there is one, `<url>.es.glsl`. Rejects with what is wrong. */
export function loadModel( url: string | URL ): Promise<PeelnetModel>;

/** What is wrong with a model, as one sentence, or null where nothing is. */
export function modelProblem( model: unknown ): string | null;
