use super::*;
use peelnet_core::{
    absorbance::{DepthWarp, absorbance},
    fragment::Fragment,
    methods::over,
};
use std::path::Path;

fn entry(text: &str) -> Entry {
    let text = format!("[[design]]\nname = \"one\"\n{text}");
    parse(&text, Path::new("f.toml")).unwrap().remove(0)
}

/// A view of four pixels, of which two hold these lists.
fn view(lists: [Vec<Fragment>; 2]) -> View {
    let [a, b] = lists;
    View::new("s", DepthWarp::new(1.0, 100.0), 4, [(0, a), (3, b)])
}

/// One slab without records: half of the others' absorbance lies in front of each fragment.
#[test]
fn one_slab_without_records_is_a_closed_form() {
    let text = "ends = [1.0]\nmeans = [false]\nnearest = [false]\nfarthest = [false]\n";
    let alphas = [0.5f32, 0.75, 0.25];
    let colors = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let fragment = |i: usize| Fragment::new(10.0 * (i + 1) as f32, alphas[i], colors[i]);
    let list: Vec<Fragment> = (0..3).map(fragment).collect();
    let total: f64 = alphas.iter().map(|&a| absorbance(a)).sum();
    let shares = alphas.map(|a| f64::from(a) * (-0.5 * (total - absorbance(a))).exp());
    let left = 1.0 - (-total).exp();
    let sum: f64 = shares.iter().sum();
    let exact = over::composite_f64(&list, [0.0; 3]);
    // Fragment i is alone in channel i. Two of the four pixels hold the list.
    let squares = [0, 1, 2].map(|i| (shares[i] / sum * left - exact[i]).powi(2));
    let expected = 2.0 * squares.iter().sum::<f64>() / 12.0;
    let found = entry(text).measure(&view([list.clone(), list]), None);
    let off = (found.mse_linear / expected - 1.0).abs();
    // Roundings to 2⁻¹¹, of differences of a tenth.
    assert!(off < 0.02, "{} is not {expected}", found.mse_linear);
    assert_eq!(found.contour_pairs, None);
}

/// Two scenes with ratios 1/4 and 1 to the moments, and 1 and 1/4 to the buffer.
#[test]
fn scores_are_geometric_means_and_the_worst_scene() {
    let warp = DepthWarp::new(1.0, 100.0);
    let views = ["a", "b"].map(|scene| View::new(scene, warp, 4, []));
    let of = |errors: [f64; 2], pairs: [Option<f64>; 2]| {
        [0, 1].map(|k| Measured {
            mse_linear: errors[k],
            contour_pairs: pairs[k],
            flicker: [pairs[k], None],
        })
    };
    let own = of([1e-3, 1e-3], [Some(0.5), None]);
    let moments = of([4e-3, 1e-3], [None; 2]);
    let kbuffer = of([1e-3, 4e-3], [None; 2]);
    let score = score(&views, &own, &moments, &kbuffer);
    let close = |a: Option<f64>, b: f64| (a.unwrap() - b).abs() < 1e-12;
    assert!(close(score.to_moments, 0.5), "{score:?}");
    assert!(close(score.to_kbuffer, 0.5), "{score:?}");
    assert_eq!(score.worst_scene.as_deref(), Some("b"));
    assert!(close(score.worst, 1.0), "{score:?}");
    assert!(close(score.contour_pairs, 0.5), "{score:?}");
    assert!(close(score.flicker[0], 0.5) && score.flicker[1].is_none());
}
