//! `linked-list`: every fragment in its pixel's linked list, in one geometry pass (Yang, Hensley, Grün & Thibieroz 2010).
//!
//! A pool that turns out too small is made larger for the next frame, which counts as too small until then: nothing is dropped silently.
//! One thread sorts and composites a list, so lists of more than 1,024 nodes are not walked: such frames are drawn from the S-buffer, with
//! colours rounded as the list rounds them.

mod expectations;

use crate::geometry::count::CountPass;
use crate::gpu::wgpu;
use crate::methods::{
    abuffer::{self, FIRST_GUESS},
    prelude::*,
    stored_colors::{self, COLORS},
};
use crate::passes::Allocated;

const NODES: Parameter = Parameter::whole(
    "nodes",
    "size of the first pool; it grows as needed",
    None,
    (1, 1 << 32),
);

pub(super) const METHOD: Method = Method {
    parameters: &[NODES, COLORS],
    curve: &["", ":colors=f16", ":colors=u8"],
    expectations: expectations::METHOD,
    ..Method::own(
        "linked-list",
        "exact: one pass into a list for each pixel, sorted by relinking",
        build,
    )
};

#[derive(Debug)]
struct LinkedList {
    /// Nodes of the pool.
    nodes: u64,
    /// `Found` in `methods/linked_list/composite.wgsl`; none where the S-buffer draws instead, since a list was too long.
    found: Option<wgpu::Buffer>,
    passes: Box<dyn Compositor>,
}

fn build(b: &Build<'_>) -> Result<Box<dyn Compositor>, RenderError> {
    let found = b.scene.gpu.storage("nodes found", 20)?;
    let pixels = u64::from(b.frame.pixels());
    let nodes = NODES.count(b.spec).unwrap_or(pixels * FIRST_GUESS);
    Ok(Box::new(LinkedList {
        nodes,
        passes: passes(b, &found, nodes)?,
        found: Some(found),
    }))
}

/// The passes with a pool of so many nodes.
fn passes(
    b: &Build<'_>,
    found: &wgpu::Buffer,
    nodes: u64,
) -> Result<Box<dyn Compositor>, RenderError> {
    let (_, color_bytes, layout) = stored_colors::layout(b.spec);
    let tinted = b.scene.tinted;
    let features = || layout.into_iter().chain(tinted.then_some("tinted"));
    let mut p = Passes::new(b.conditions());
    let heads = p.storage("heads", 4, 0);
    let found = p.given("found", Allocated::Storage(found.clone()));
    let camera = p.given("camera", Allocated::Uniform(b.scene.camera.clone()));
    // Not cleared: lists end where their links say.
    let mut pool = |name, bytes: u32| p.uncleared(name, nodes * u64::from(bytes));
    let next = pool("next", 4);
    let depths = pool("depths", 4);
    let triangles = pool("triangles", 4);
    // Where light takes a colour two of a fragment.
    let colors = pool("colors", color_bytes * if tinted { 2 } else { 1 });
    p.geometry(
        "methods::linked_list::build",
        Needs::COLOR | Needs::TRIANGLE,
    )
    .features(features())
    .writes([heads, found, next, depths, triangles, colors]);
    let read = [camera, heads, depths, triangles, colors];
    p.resolve("methods::linked_list::composite", read)
        .features(features())
        .writes([next, found]);
    p.build(b)
}

impl Compositor for LinkedList {
    fn draw(&mut self, cx: &mut DrawContext<'_, '_>) -> Result<FrameStats, RenderError> {
        if let Some(found) = &self.found {
            cx.recorder.encoder().clear_buffer(found, 0, None);
        }
        self.passes.draw(cx)
    }

    fn is_ready(&self) -> bool {
        self.passes.is_ready()
    }

    fn feedback(&self) -> Vec<wgpu::Buffer> {
        match &self.found {
            Some(found) => vec![found.clone()],
            None => self.passes.feedback(),
        }
    }

    fn learn(
        &mut self,
        b: &Build<'_>,
        exact: bool,
        words: &[Vec<u32>],
        stats: &mut FrameStats,
    ) -> Result<Fit, RenderError> {
        let Some(found) = &self.found else {
            return self.passes.learn(b, exact, words, stats);
        };
        let &[used, too_long, composited, unsorted, pixel] = words[0].as_slice() else {
            return Ok(Fit::TooSmall);
        };
        let needed = u64::from(used);
        stats.fragments = Some(needed);
        if too_long == 0 && needed <= self.nodes {
            let lost = used.saturating_sub(composited);
            let uncounted = composited.saturating_sub(used);
            CountPass::check(&[unsorted, lost, uncounted, pixel], b.frame.size[0])?;
            return Ok(Fit::Whole);
        }
        if too_long > 0 {
            let (_, _, layout) = stored_colors::layout(b.spec);
            self.passes = abuffer::build_with(b, layout)?;
            self.found = None;
        } else {
            // A quarter more, so that a moving camera does not grow it every frame.
            self.nodes = needed + needed / 4;
            self.passes = passes(b, found, self.nodes)?;
        }
        Ok(Fit::TooSmall)
    }
}
