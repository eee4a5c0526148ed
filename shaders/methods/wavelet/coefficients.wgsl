// wavelet, pass 1: every fragment's absorbance as a step, in wavelets.
import package::helpers::absorbance::absorbance;
import package::methods::wavelet::haar::{Coefficients, in_bins, step_at};
import package::scene::shade::opacity;
import package::scene::surface::Surface;
import package::scene::visible::visible;

@fragment
fn fragment_main(surface: Surface) -> Coefficients {
    if !visible(surface) {
        discard;
    }
    return step_at(in_bins(surface), absorbance(opacity(surface)));
}
