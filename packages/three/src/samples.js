// A frame as the mean of several, each drawn at another place in the pixel: statistics, weights and the image by sample.

import { NoBlending, RenderTarget } from 'three/webgpu';
import { ivec2, screenCoordinate, textureLoad } from 'three/tsl';
import { ADD, drawQuad, fullScreen, over } from './full-screen.js';

/** Whether a frame can be the mean of so many. */
export const isCount = ( count ) => [ 0, 1, 2, 4, 6, 8, 10, 12, 14, 16 ].includes( count );

// Places in the pixel, no two in a row or a column; of four, those of WebGPU's multisampling.
const placeOf = ( i, count ) => [ ( ( 1 + 2 * i ) % ( count + 1 ) + 0.5 ) / count, ( i + 0.5 ) / count ];

export class Samples {

	/** Of an even `count`; `type` is that of the image, `outputs` what else is in its target. */
	constructor( count, type, outputs ) {

		const texel = ivec2( screenCoordinate.xy );

		this._count = count;
		this._target = new RenderTarget( 1, 1, { type, depthBuffer: false, samples: 0 } );
		this._drawn = textureLoad( this._target.texture, texel );
		this._add = fullScreen( 'sample', { fragmentNode: this._drawn.div( count ), transparent: true } );
		this._mean = over( textureLoad( this._target.texture, texel ), outputs, { blending: NoBlending } );

	}

	/** Calls `draw( i )` for each sample, with the camera moved by less than a pixel, and leaves their mean in the target. */
	draw( renderer, camera, target, draw ) {

		const { aspect: width = 1 } = camera;
		const offset = camera.view?.enabled ? { ...camera.view } : null;
		const view = offset ?? { fullWidth: width, fullHeight: 1, offsetX: 0, offsetY: 0, width, height: 1 };

		for ( let i = 0; i < this._count; i ++ ) {

			const [ x, y ] = placeOf( i, this._count );
			const { z, w } = target.viewport;

			camera.setViewOffset( view.fullWidth, view.fullHeight, view.offsetX + ( x - 0.5 ) * view.width / z, view.offsetY + ( y - 0.5 ) * view.height / w, view.width, view.height );
			draw( i );

			// The first one replaces the last frame's.
			Object.assign( this._add.material, i === 0 ? { blending: NoBlending } : ADD );
			// Which texture the pass draws into may change from frame to frame.
			this._drawn.value = target.texture;
			this._target.setSize( target.width, target.height );
			drawQuad( renderer, { quad: this._add, target: this._target } );

		}

		if ( offset === null ) camera.clearViewOffset();
		else camera.setViewOffset( offset.fullWidth, offset.fullHeight, offset.offsetX, offset.offsetY, offset.width, offset.height );

		drawQuad( renderer, { ...this._mean, target } );

	}

	dispose() {

		for ( const made of [ this._target, this._add.material, this._mean.quad.material ] ) made.dispose();

	}

}
