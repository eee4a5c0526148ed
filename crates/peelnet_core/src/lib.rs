//! The mathematics of transparency, without GPU, scenes or training; and, below all other crates, the rules of files ([`files`]).
//!
//! A pixel is a list of [`fragment::Fragment`]s. [`methods`] turns such a list into a colour: exactly
//! ([`methods::over`]) or by what learned methods are made of, one file each. [`weights`] holds the published weight functions, [`mlp`] the
//! network's forward pass, [`scanline`] a 64-bit rasteriser that checks what the GPU peels, and [`tolerance`] the error bounds that tests may use, each with its reason.
//!
//! Notation (per pixel, nearest fragment first): depth `z_i`, opacity `α_i`, radiance `c_i`, premultiplied
//! `C_i = α_i c_i`, background `C_0`, transmittance in front of a fragment `T_i = ∏_{j<i}(1 − α_j)`, and of the
//! whole pixel `T_∞`. Ground truth is Porter and Duff's *over*, `C = Σ C_i T_i + T_∞ C_0`.
//!
//! The worked example of the whole project is four fragments, see [`fragment::worked_example`].

#![allow(missing_docs)]

pub mod absorbance;
pub mod files;
pub mod fragment;
pub mod guards;
pub mod hash;
pub mod methods;
pub mod mlp;
pub mod random;
pub mod scanline;
pub mod shading;
pub mod srgb;
pub mod statistics;
pub mod tolerance;
pub mod weights;
