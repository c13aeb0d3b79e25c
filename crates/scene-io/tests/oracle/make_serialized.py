"""Writes the serialized meshes here, and what Mitsuba 3 sees of them (for `tests/conventions.rs`)."""
import struct
import zlib

import mitsuba as mi
mi.set_variant('scalar_rgb')
V=[(-1,-1,0),(1,-1,0),(1,1,.5),(-1,1,0)]; F=[(0,1,2),(0,2,3)]
UV=[(0,0),(1,0),(1,1),(0,1)]
N=[(0,0,1),(0.2,0,1),(0,0.3,1),(0,0,1)]
def mesh(version=4, flags=0x1000, name=b'quad', scale=1):
    f = 'd' if flags & 0x2000 else 'f'
    d = struct.pack('<I', flags)
    if version == 4: d += name + b'\0'
    d += struct.pack('<QQ', len(V), len(F))
    for p in V: d += struct.pack('<3'+f, *[x*scale for x in p])
    if flags & 1:
        for p in N: d += struct.pack('<3'+f, *p)
    if flags & 2:
        for p in UV: d += struct.pack('<2'+f, *p)
    if flags & 8:
        for p in V: d += struct.pack('<3'+f, .1,.2,.3)
    for t in F: d += struct.pack('<3I', *t)
    return struct.pack('<HH', 0x041C, version) + zlib.compress(d)
def write(path, version, *meshes):
    offsets=[]; out=b''
    for m in meshes:
        offsets.append(len(out)); out+=m
    for o in offsets: out += struct.pack('<Q' if version==4 else '<I', o)
    out += struct.pack('<I', len(offsets))
    open(path,'wb').write(out)
write('quads4.serialized',4, mesh(4,0x1000), mesh(4,0x2003,b'second',2), mesh(4,0x1010,scale=3), mesh(4,0x100b,scale=4))
write('quads3.serialized',3, mesh(3,0x1001), mesh(3,0x2002,scale=2))
def look(file,i,extra={}):
    s=mi.load_dict({'type':'scene','s':{'type':'serialized','filename':file,'shape_index':i,**extra}})
    si=s.ray_intersect(mi.Ray3f([0.5,-0.2,9],[0,0,-1]))
    print(file,i,extra, 'p',[round(x,6) for x in si.p],'n',[round(x,6) for x in si.sh_frame.n],'uv',[round(x,6) for x in si.uv])
for i in range(4): look('quads4.serialized',i)
for i in range(2): look('quads3.serialized',i)
look('quads4.serialized',1,{'face_normals':True})
look('quads4.serialized', 1, {'flip_normals': True})
