//! The nodes of a file are trees: a node with two parents would be drawn twice, and so on at every level below it.

/// Checks that no node has two parents or is its own descendant, and that the roots of a scene are roots.
pub(super) fn check_nodes(document: &gltf::Document) -> Result<(), String> {
    let mut parents: Vec<Option<usize>> = vec![None; document.nodes().len()];
    for node in document.nodes() {
        for child in node.children() {
            let parent = &mut parents[child.index()];
            if let Some(other) = parent.replace(node.index()) {
                return Err(twice(
                    child.index(),
                    &format!("nodes {other} and {}", node.index()),
                ));
            }
        }
    }
    let mut reached = vec![false; parents.len()];
    let mut open: Vec<gltf::Node<'_>> = document.nodes().collect();
    open.retain(|node| parents[node.index()].is_none());
    while let Some(node) = open.pop() {
        reached[node.index()] = true;
        open.extend(node.children());
    }
    if let Some(node) = reached.iter().position(|reached| !reached) {
        return Err(format!(
            "node {node} is among its own descendants, or below such a node; take one of them out of the circle"
        ));
    }
    for scene in document.scenes() {
        let mut is_root = vec![false; parents.len()];
        for node in scene.nodes() {
            let node = node.index();
            let again = std::mem::replace(&mut is_root[node], true);
            if again {
                return Err(twice(node, &format!("scene {} twice", scene.index())));
            }
            if let Some(parent) = parents[node] {
                let both = format!("scene {} and node {parent}", scene.index());
                return Err(twice(node, &both));
            }
        }
    }
    Ok(())
}

fn twice(node: usize, whom: &str) -> String {
    format!(
        "node {node} is a child of {whom}: a node has one parent; give each place a node of its own, which may name the same mesh"
    )
}
