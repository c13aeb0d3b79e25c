//! What can be wrong with a tree.

/// Where a tree is not what it should be: a fault of its build, or of how lights are merged.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum TreeError {
    /// Children do not come after their parents, or leaves are not numbered from left to right.
    #[error("node {node} is out of order")]
    Order {
        /// Which.
        node: u32,
    },
    /// A leaf's light is not its own.
    #[error("leaf {node} is not the leaf of its light")]
    Leaf {
        /// Which.
        node: u32,
    },
    /// A representative is neither child's.
    #[error("the representative of node {node} is neither of those of its children")]
    Representative {
        /// Which.
        node: u32,
    },
    /// A cluster does not hold those of its children.
    #[error("the cluster of node {node} does not hold those of its children")]
    Cluster {
        /// Which.
        node: u32,
    },
    /// Some nodes or lights cannot be reached.
    #[error("{seen} of {nodes} nodes can be reached from the root")]
    Count {
        /// How many there are.
        nodes: usize,
        /// How many can be reached.
        seen: usize,
    },
}
