"""The dialects in which one small stair is written: each by another library, or as known software exports it.

Another one is a line here.
"""

import csv
import gzip
import zipfile

import numpy as np
import trimesh

from stair_inspector.files.ply import ply_bytes
from tests.files.copc_files import copc_file
from tests.files.dialect_writers import (
    COLORS,
    INTENSITY,
    POINTS,
    N,
    Written,
    axes,
    by_path,
    called,
    e57,
    frame,
    intensity,
    las,
    lines,
    npy,
    npz,
    organised,
    pcd,
    ply_header,
    ptx,
    rgb,
    savetxt,
    table,
    with_csv,
    with_open3d,
    with_plyfile,
    zipped,
)

TITLES = "House 12\n2024-05-01\nX,Y,Z\nmm,mm,mm\n"
PDAL = '"X","Y","Z","Intensity","ReturnNumber"\n'
LIVOX = "Timestamp,X,Y,Z,Reflectivity\n"
GERMAN = "Punktnummer;Rechtswert;Hochwert;Höhe\r\n"
SINGLE = 1e-7
DIALECTS: dict[str, Written] = {
    # numpy, pandas, csv
    "numpy.savetxt": Written(".txt", savetxt),
    "numpy.savetxt, csv": Written(".csv", lambda: savetxt(delimiter=",", header="x,y,z", comments="")),
    "numpy.savetxt, header": Written(".txt", lambda: savetxt(header="x y z", fmt="%.4f")),
    "numpy.savetxt, tabs, footer": Written(".tsv", lambda: savetxt(delimiter="\t", footer="end", fmt="%.6g")),
    "pandas": Written(".csv", lambda: frame().to_csv()),
    "pandas, German": Written(".csv", lambda: frame().to_csv(index=False, sep=";", decimal=",")),
    "pandas, quoted": Written(".csv", lambda: frame().astype(str).to_csv(index=False, quoting=csv.QUOTE_ALL)),
    "pandas, byte order mark": Written(".csv", lambda: frame().to_csv(index=False).encode("utf-8-sig")),
    "pandas, printed": Written(".txt", lambda: frame().to_string()),
    "csv, excel": Written(".csv", lambda: with_csv("excel")),
    "csv, excel-tab": Written(".txt", lambda: with_csv("excel-tab")),
    "csv, unix": Written(".csv", lambda: with_csv("unix", ("X [m]", "Y [m]", "Z [m]"))),
    # spreadsheets and surveyors
    "Excel, German": Written(".csv", lambda: lines(sep=";", comma=True, end="\r\n", head=GERMAN, before=called)),
    "Excel, German, cp1252": Written(
        ".csv", lambda: lines(sep=";", comma=True, end="\r\n", head=GERMAN, before=called).encode("cp1252")
    ),
    "Excel, trailing": Written(".csv", lambda: lines(sep=";", comma=True, end=";;\r\n", head="X;Y;Z;;\r\n")),
    "Excel, Unicode text": Written(".txt", lambda: lines(sep="\t").encode("utf-16"), refused="save it as UTF-8"),
    "LibreOffice, French": Written(
        ".csv", lambda: lines(sep=";", comma=True, head='"Abscisse";"Ordonnée";"Altitude"\n')
    ),
    "Trimble Business Center": Written(
        ".csv",
        lambda: lines(
            sep=",",
            head="Point ID,Easting (Meter),Northing (Meter),Elevation (Meter),Feature Code\n",
            before=called,
            behind=lambda k: ("STEP" if k % 3 else "",),
        ),
    ),
    "Trimble, northing first": Written(
        ".csv",
        lambda: lines(sep=",", head="Name,Northing,Easting,Elevation\n", before=called, points=POINTS[:, [1, 0, 2]]),
    ),
    "Leica, names first": Written(".txt", lambda: lines(sep="  ", before=called)),
    "Leica, numbers first": Written(
        ".txt", lambda: lines(before=lambda k: (str(k + 1),)), refused="give --columns x,y,z or --columns -,x,y,z"
    ),
    "Leica, numbers first, told": Written(".txt", lambda: lines(before=lambda k: (str(k + 1),)), columns="-,x,y,z"),
    "AutoCAD, title and units": Written(
        ".csv", lambda: lines(form="{:.1f}", sep=",", points=POINTS * 1000.0, head=TITLES), unit="auto"
    ),
    "GIS, coordinates behind": Written(
        ".csv", lambda: lines(sep=",", head="OBJECTID,POINT_X,POINT_Y,POINT_Z\n", before=lambda k: (str(k),))
    ),
    "degrees": Written(".csv", lambda: lines(sep=",", head="lat,lon,alt\n"), refused="degrees are not read"),
    "Fortran": Written(".dat", lambda: lines(form=" {:.9E}", sep=" ").replace("E", "D")),
    "Fortran, remarks": Written(".dat", lambda: lines(sep="   ", head="! points\n", foot="! end\n")),
    "Surfer": Written(".dat", lambda: lines(head="; Surfer\n", sep="\t")),
    "MATLAB": Written(".txt", lambda: lines(form="  {:.7e}", sep=" ")),
    "R, write.table": Written(".txt", lambda: lines(head='"x" "y" "z"\n', before=lambda k: (f'"{k + 1}"',))),
    "R, write.csv2": Written(
        ".csv", lambda: lines(sep=";", comma=True, head='"";"x";"y";"z"\n', before=lambda k: (f'"{k + 1}"',))
    ),
    # programs for scans
    "CloudCompare": Written(
        ".asc", lambda: lines(head=f"//X Y Z R G B Intensity\n{N}\n", behind=lambda k: (*rgb(k), *intensity(k)))
    ),
    "CloudCompare, csv": Written(".csv", lambda: lines(sep=",", head="//X,Y,Z,Nx,Ny,Nz\n", behind=lambda k: "001")),
    "PDAL": Written(".txt", lambda: lines(sep=",", head=PDAL, behind=lambda k: (*intensity(k), "1"))),
    "Leica Cyclone": Written(".pts", lambda: lines(head=f"{N}\n", behind=lambda k: (*intensity(k), *rgb(k)))),
    "Autodesk ReCap": Written(
        ".pts",
        lambda: lines(head=f"{N}\r\n", end="\r\n", behind=lambda k: (*intensity(k), *rgb(k))),
    ),
    "Leica Cyclone, xyz": Written(".xyz", lambda: lines(form="{:.6f}", behind=intensity)),
    "FARO Scene": Written(".xyz", lambda: lines(behind=rgb)),
    "Riegl": Written(
        ".asc", lambda: lines(sep=",", head="X[m],Y[m],Z[m],Amplitude[dB]\n", behind=lambda k: ("12.5",)), unit="auto"
    ),
    "Zoller+Froehlich": Written(".asc", lambda: lines(behind=lambda k: ("0.25",))),
    "Agisoft Metashape": Written(".txt", lambda: lines(behind=lambda k: (*rgb(k), "0.0", "0.6", "0.8"))),
    "RealityCapture": Written(".csv", lambda: lines(sep=",", head="#x,y,z,r,g,b\n", behind=rgb)),
    "MeshLab": Written(".xyz", lambda: lines(behind=lambda k: ("0", "0.6", "0.8"))),
    "ParaView": Written(
        ".csv",
        lambda: lines(sep=",", head='"Points:0","Points:1","Points:2"\n'),
    ),
    "Livox Viewer": Written(
        ".csv", lambda: lines(sep=",", head=LIVOX, before=lambda k: (f"{k / 1e5}",), behind=intensity)
    ),
    "millimetres in brackets": Written(
        ".xyz", lambda: lines(form="{:.1f}", points=POINTS * 1000.0, head="x(mm) y(mm) z(mm)\n"), unit="auto"
    ),
    "GeoJSON": Written(".json", lambda: '{"type": "FeatureCollection"}\n', refused="is neither numbers nor"),
    "LandXML": Written(".xml", lambda: "<?xml version='1.0'?>\n<LandXML/>\n", refused="is neither numbers nor"),
    "DXF": Written(".dxf", lambda: "0\nSECTION\n2\nENTITIES\n0\nENDSEC\n", refused="is neither numbers nor"),
    # PLY
    "this package": Written(".ply", lambda: ply_bytes(POINTS, COLORS)),
    "plyfile": Written(".ply", with_plyfile),
    "plyfile, single": Written(".ply", lambda: with_plyfile("f4"), coarse_m=SINGLE),
    "plyfile, big endian": Written(".ply", lambda: with_plyfile(order=">")),
    "plyfile, ascii": Written(".ply", lambda: with_plyfile(text=True)),
    "plyfile, lists": Written(".ply", lambda: with_plyfile(lists=True)),
    "plyfile, ascii lists": Written(".ply", lambda: with_plyfile(text=True, lists=True)),
    "trimesh cloud": Written(
        ".ply", lambda: trimesh.PointCloud(POINTS, COLORS).export(file_type="ply"), coarse_m=SINGLE
    ),
    "PCL, camera": Written(
        ".ply",
        lambda: (
            ply_header([("double", "x"), ("double", "y"), ("double", "z")], more="obj_info a\n").replace(
                b"end_header\n", b"element camera 1\nproperty float view_px\nend_header\n"
            )
            + POINTS.astype("<f8").tobytes()
            + b"\0\0\0\0"
        ),
    ),
    "MeshLab, flags": Written(
        ".ply",
        lambda: (
            ply_header([("double", "x"), ("double", "y"), ("double", "z"), ("int", "flags"), ("float", "quality")])
            + table(**axes("<f8"), flags=np.zeros(N, "<i4"), quality=np.zeros(N, "<f4")).tobytes()
        ),
    ),
    "more columns than names": Written(
        ".ply",
        lambda: (
            ply_header([("float", "x"), ("float", "y"), ("float", "z")], "ascii")
            + lines(behind=lambda k: "00").encode()
        ),
    ),
    "Open3D, PLY": by_path(".ply", with_open3d("a.ply")),
    "Open3D, ascii PLY": by_path(".ply", with_open3d("a.ply", write_ascii=True)),
    # PCD
    "Open3D, PCD": by_path(".pcd", with_open3d("a.pcd"), coarse_m=SINGLE),
    "Open3D, ascii PCD": by_path(".pcd", with_open3d("a.pcd", write_ascii=True), coarse_m=1e-6),
    "Open3D, compressed PCD": by_path(".pcd", with_open3d("a.pcd", compressed=True), coarse_m=SINGLE),
    "Open3D, XYZ": by_path(".xyz", with_open3d("a.xyz")),
    "Open3D, XYZN": by_path(".xyzn", with_open3d("a.xyzn")),
    "Open3D, PTS": by_path(".pts", with_open3d("a.pts")),
    "ROS, padding": Written(
        ".pcd",
        lambda: pcd(
            "x y z _ intensity",
            "4 4 4 1 4",
            "F F F U F",
            "1 1 1 4 1",
            table(**axes(), pad=np.zeros(N, "V4"), i=np.zeros(N, "<f4")).tobytes(),
        ),
        coarse_m=SINGLE,
    ),
    "PDAL, padding of nothing": Written(
        ".pcd",
        lambda: pcd(
            "x y z _ t _", "8 8 8 1 8 1", "F F F U F U", "1 1 1 0 1 0", table(**axes("<f8"), t=np.zeros(N)).tobytes()
        ),
    ),
    "depth camera": Written(".pcd", organised, coarse_m=SINGLE),
    # LAS, LAZ, stations
    "laspy 1.2": Written(".las", las),
    "laspy 1.4": Written(".las", lambda: las(7)),
    "laspy 1.4, offset": Written(".las", lambda: las(6, offset=-1000.0)),
    "laspy, LAZ": Written(".laz", lambda: las(1, packed=True)),
    "laspy, LAZ 1.4": Written(".laz", lambda: las(7, packed=True)),
    "COPC": Written(".copc.laz", lambda: copc_file(POINTS)[0], is_sorted=True),
    "laspy, a millimetre": Written(".las", lambda: las(0, scale=0.001), coarse_m=0.0005001),
    "PTX": Written(".ptx", ptx),
    "E57": by_path(".e57", e57),
    # arrays and archives
    "numpy.save": Written(".npy", lambda: npy(POINTS)),
    "numpy.save, single": Written(".npy", lambda: npy(POINTS.astype(np.float32)), coarse_m=SINGLE),
    "numpy.save, fields": Written(".npy", lambda: npy(table(**axes("<f8"), intensity=INTENSITY))),
    "numpy.save, objects": Written(
        ".npy", lambda: npy(POINTS[:3].astype(object), allow_pickle=True), refused="Python objects"
    ),
    "numpy.savez": Written(".npz", lambda: npz(points=POINTS, colors=COLORS)),
    "numpy.savez_compressed": Written(".npz", lambda: npz(np.savez_compressed, **axes("<f8"))),
    "gzip": Written(".ply.gz", lambda: gzip.compress(ply_bytes(POINTS, COLORS))),
    "gzip of text": Written(".csv.gz", lambda: gzip.compress(frame().to_csv(index=False).encode())),
    "ZIP": Written(".zip", lambda: zipped(zipfile.ZIP_DEFLATED, stair__las=las(), readme__txt="a stair")),
    "ZIP, stored": Written(".zip", lambda: zipped(zipfile.ZIP_STORED, stair__xyz=lines())),
    "ZIP of two": Written(
        ".zip",
        lambda: zipped(zipfile.ZIP_DEFLATED, a__las=las(), b__xyz=lines()),
        refused="holds 2 scans (a.las, b.xyz)",
    ),
}
