//! Embree 4 as a yardstick: triangles in, single rays and packets of eight through them.
//!
//! Nothing is linked: the library is opened at run time from the file that the caller names, and benchmarks go without it
//! where there is none. Only what the benchmarks ask is here. The layouts and names are those of Embree's public headers
//! (`rtcore_ray.h`, `rtcore_scene.h`, `rtcore_geometry.h` of version 4).
//!
//! ```no_run
//! let embree = manylight_embree::Embree::open("libembree4.so".as_ref())?;
//! let scene = embree.scene(&[[0.0; 3]; 3], &[[0, 1, 2]], manylight_embree::Mode::Robust);
//! assert!(!scene.occluded([0.0, 0.0, 1.0], [0.0, 0.0, 1.0], f32::INFINITY));
//! # Ok::<(), manylight_embree::Error>(())
//! ```

pub mod rays;

use libloading::Library;
use std::ffi::{c_char, c_int, c_uint, c_void};
use std::path::Path;

/// Why Embree cannot be used.
#[derive(Debug)]
pub struct Error(String);
impl std::fmt::Display for Error {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.0)
    }
}
impl std::error::Error for Error {}

/// How a scene is built. Both by the builder of highest quality.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mode {
    /// Embree's default: rays may slip through edges.
    Fast,
    /// `RTC_SCENE_FLAG_ROBUST`.
    Robust,
}

type Handle = *mut c_void;

/// `RTCRay`.
#[repr(C, align(16))]
#[derive(Clone, Copy)]
struct Ray {
    org: [f32; 3],
    tnear: f32,
    dir: [f32; 3],
    time: f32,
    tfar: f32,
    mask: c_uint,
    id: c_uint,
    flags: c_uint,
}
/// `RTCRayHit`, with room to spare: the hit grew by a field within version 4.
#[repr(C, align(16))]
struct RayHit {
    ray: Ray,
    ng: [f32; 3],
    uv: [f32; 2],
    prim: c_uint,
    geom: c_uint,
    inst: [c_uint; 9],
}
/// `RTCRay8`.
#[repr(C, align(32))]
struct Ray8 {
    org: [[f32; 8]; 3],
    tnear: [f32; 8],
    dir: [[f32; 8]; 3],
    time: [f32; 8],
    tfar: [f32; 8],
    mask: [c_uint; 8],
    id: [c_uint; 8],
    flags: [c_uint; 8],
}
#[repr(C, align(32))]
struct Valid([c_int; 8]);

struct Functions {
    new_device: unsafe extern "C" fn(*const c_char) -> Handle,
    new_scene: unsafe extern "C" fn(Handle) -> Handle,
    scene_flags: unsafe extern "C" fn(Handle, c_uint),
    scene_quality: unsafe extern "C" fn(Handle, c_uint),
    commit_scene: unsafe extern "C" fn(Handle),
    new_geometry: unsafe extern "C" fn(Handle, c_uint) -> Handle,
    buffer: unsafe extern "C" fn(Handle, c_uint, c_uint, c_uint, usize, usize) -> *mut c_void,
    commit_geometry: unsafe extern "C" fn(Handle),
    attach: unsafe extern "C" fn(Handle, Handle) -> c_uint,
    intersect: unsafe extern "C" fn(Handle, *mut RayHit, *const c_void),
    occluded: unsafe extern "C" fn(Handle, *mut Ray, *const c_void),
    occluded8: unsafe extern "C" fn(*const Valid, Handle, *mut Ray8, *const c_void),
}

/// The library, opened. It is never closed again, which it does not survive.
pub struct Embree {
    f: Functions,
    device: Handle,
}

/// A committed scene.
pub struct Scene<'a> {
    f: &'a Functions,
    scene: Handle,
}

impl Embree {
    /// Opens a `libembree4.so`.
    pub fn open(path: &Path) -> Result<Self, Error> {
        let error = |e: libloading::Error| Error(format!("{}: {e}", path.display()));
        // SAFETY: the caller names an Embree 4, whose initialisers are harmless; it stays open for good.
        let library: &'static Library = Box::leak(Box::new(unsafe { Library::new(path) }.map_err(error)?));
        macro_rules! named {
            ($name:literal) => {
                // SAFETY: the type of the field is that of the function in Embree's header.
                unsafe { *library.get($name).map_err(error)? }
            };
        }
        let f = Functions {
            new_device: named!(b"rtcNewDevice"),
            new_scene: named!(b"rtcNewScene"),
            scene_flags: named!(b"rtcSetSceneFlags"),
            scene_quality: named!(b"rtcSetSceneBuildQuality"),
            commit_scene: named!(b"rtcCommitScene"),
            new_geometry: named!(b"rtcNewGeometry"),
            buffer: named!(b"rtcSetNewGeometryBuffer"),
            commit_geometry: named!(b"rtcCommitGeometry"),
            attach: named!(b"rtcAttachGeometry"),
            intersect: named!(b"rtcIntersect1"),
            occluded: named!(b"rtcOccluded1"),
            occluded8: named!(b"rtcOccluded8"),
        };
        // SAFETY: a null configuration is allowed.
        let device = unsafe { (f.new_device)(std::ptr::null()) };
        if device.is_null() {
            return Err(Error(format!("{}: it makes no device", path.display())));
        }
        Ok(Embree { f, device })
    }
    /// Triangles over vertices. Panics if a triangle names a vertex that is not there.
    pub fn scene(&self, vertices: &[[f32; 3]], triangles: &[[u32; 3]], mode: Mode) -> Scene<'_> {
        assert!(triangles.iter().flatten().all(|v| (*v as usize) < vertices.len()), "a vertex is not there");
        const TRIANGLE: c_uint = 0;
        const INDEX: (c_uint, c_uint) = (0, 0x5003); // RTC_BUFFER_TYPE_INDEX, RTC_FORMAT_UINT3
        const VERTEX: (c_uint, c_uint) = (1, 0x9003); // RTC_BUFFER_TYPE_VERTEX, RTC_FORMAT_FLOAT3
        const ROBUST: c_uint = 1 << 2;
        const HIGH: c_uint = 2;
        let f = &self.f;
        // SAFETY: the order of calls is that of Embree's tutorial; the buffers that it hands out hold as many elements as were
        // asked for, are aligned to 16, and are filled before the commit.
        let scene = unsafe {
            let scene = (f.new_scene)(self.device);
            (f.scene_flags)(scene, if mode == Mode::Robust { ROBUST } else { 0 });
            (f.scene_quality)(scene, HIGH);
            let geometry = (f.new_geometry)(self.device, TRIANGLE);
            let v = (f.buffer)(geometry, VERTEX.0, 0, VERTEX.1, 12, vertices.len());
            std::ptr::copy_nonoverlapping(vertices.as_ptr().cast::<u8>(), v.cast(), size_of_val(vertices));
            let i = (f.buffer)(geometry, INDEX.0, 0, INDEX.1, 12, triangles.len());
            std::ptr::copy_nonoverlapping(triangles.as_ptr().cast::<u8>(), i.cast(), size_of_val(triangles));
            (f.commit_geometry)(geometry);
            (f.attach)(scene, geometry);
            (f.commit_scene)(scene);
            scene
        };
        Scene { f, scene }
    }
}

/// An id that no geometry has.
const NOTHING: c_uint = c_uint::MAX;

fn ray(origin: [f32; 3], dir: [f32; 3], t_max: f32) -> Ray {
    Ray { org: origin, tnear: 0.0, dir, time: 0.0, tfar: t_max, mask: c_uint::MAX, id: 0, flags: 0 }
}

impl Scene<'_> {
    /// Distance and triangle of the first hit.
    #[inline]
    pub fn intersect(&self, origin: [f32; 3], dir: [f32; 3], t_max: f32) -> Option<(f32, u32)> {
        let ray = ray(origin, dir, t_max);
        let mut hit = RayHit { ray, ng: [0.0; 3], uv: [0.0; 2], prim: NOTHING, geom: NOTHING, inst: [NOTHING; 9] };
        // SAFETY: the scene is committed, the ray lives, null arguments are allowed.
        unsafe { (self.f.intersect)(self.scene, &mut hit, std::ptr::null()) };
        (hit.geom != NOTHING).then_some((hit.ray.tfar, hit.prim))
    }
    /// Is anything hit?
    #[inline]
    pub fn occluded(&self, origin: [f32; 3], dir: [f32; 3], t_max: f32) -> bool {
        let mut ray = ray(origin, dir, t_max);
        // SAFETY: as above.
        unsafe { (self.f.occluded)(self.scene, &mut ray, std::ptr::null()) };
        ray.tfar < 0.0
    }
    /// The same of up to eight rays (origin, direction, end) at once; bit k is the answer to ray k.
    #[inline]
    pub fn occluded8(&self, rays: &[([f32; 3], [f32; 3], f32)]) -> u32 {
        let axis = |f: &dyn Fn(usize) -> f32| std::array::from_fn(|k| if k < rays.len() { f(k) } else { 0.0 });
        let mut packet = Ray8 {
            org: [0, 1, 2].map(|a| axis(&|k| rays[k].0[a])),
            tnear: [0.0; 8],
            dir: [0, 1, 2].map(|a| axis(&|k| rays[k].1[a])),
            time: [0.0; 8],
            tfar: axis(&|k| rays[k].2),
            mask: [c_uint::MAX; 8],
            id: [0; 8],
            flags: [0; 8],
        };
        let valid = Valid(std::array::from_fn(|k| if k < rays.len() { -1 } else { 0 }));
        // SAFETY: as above; rays beyond the slice are marked invalid.
        unsafe { (self.f.occluded8)(&valid, self.scene, &mut packet, std::ptr::null()) };
        (0..rays.len().min(8)).fold(0, |bits, k| bits | ((packet.tfar[k] < 0.0) as u32) << k)
    }
}
