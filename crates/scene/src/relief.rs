//! Surfaces that look rougher than they are: a texture turns the shading frame.

use crate::{Texture, TextureId};
use manylight_geometry::Surface;
use manylight_math::{Frame, Vec2, Vec3};

/// What turns the shading frame. The geometry, its geometric normal with it, stays as it is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Relief {
    /// A height h above the surface, the texture's luminance times `scale` \[m\] (Blinn 1978): the normal is that of
    /// dp/du + n (dh/du - n . dp/du) and dp/dv + n (dh/dv - n . dp/dv).
    Bump {
        /// The heights.
        height: TextureId,
        /// Multiplies them. \[m\]
        scale: f32,
    },
    /// The normal itself, in the shading frame, as the colour (n + 1) / 2.
    Normals {
        /// The normals.
        map: TextureId,
    },
}

/// The way a relief is seen from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Seen {
    Front,
    Back,
}

impl Relief {
    /// The texture that it names.
    pub fn texture(&self) -> TextureId {
        match self {
            Relief::Bump { height: id, .. } | Relief::Normals { map: id } => *id,
        }
    }
    /// The turned frame. `frame` is the shading frame on the side that is seen; `derivatives`: of the position by u and v.
    ///
    /// `inside`: the relief belongs to one side of a two-sided material, and its mirror image to the other; else the two sides
    /// see the same relief, of which one is the mould of the other. (Mitsuba 3's order of nesting says which.)
    pub(crate) fn turn(
        &self,
        textures: &[Texture],
        x: &Surface,
        (dpdu, dpdv): (Vec3, Vec3),
        frame: Frame,
        seen: Seen,
        inside: bool,
    ) -> Frame {
        let front = if seen == Seen::Front { frame } else { frame.flipped() };
        let Some(normal) = self.normal(textures, x.uv, (dpdu, dpdv), &front) else { return frame };
        let l = front.to_local(normal);
        let world = match (seen, inside) {
            (Seen::Front, _) => normal,
            (Seen::Back, true) => front.to_world(Vec3::new(l.x, l.y, -l.z)),
            (Seen::Back, false) => -normal,
        };
        Frame::with_tangent(world, frame.s)
    }
    /// The normal on the front; `None` where nothing turns it.
    fn normal(&self, textures: &[Texture], uv: Vec2, (dpdu, dpdv): (Vec3, Vec3), front: &Frame) -> Option<Vec3> {
        let n = front.n;
        let normal = match self {
            Relief::Bump { height, scale } => {
                let slope = textures[height.0 as usize].gradient(uv) * *scale;
                let turned = |along: Vec3, slope: f32| along + n * (slope - n.dot(along));
                turned(dpdu, slope.x).cross(turned(dpdv, slope.y)).try_normalize()?
            }
            Relief::Normals { map } => {
                let local = textures[map.0 as usize].at(uv).0 * 2.0 - 1.0;
                front.to_world(local.try_normalize()?)
            }
        };
        // Texture coordinates may run either way round; a normal map may point below the surface, and is then of no use.
        match self {
            Relief::Bump { .. } if normal.dot(n) < 0.0 => Some(-normal),
            Relief::Normals { .. } if !(normal.dot(n) > 0.0) => None,
            _ => Some(normal),
        }
    }
}
