"""The OME-TIFF files of write_tiffs.py."""
import os

import numpy
import tifffile

DATA = numpy.random.default_rng(6).integers(0, 60000, (2, 3, 4, 9, 10)).astype("u2")  # t c z y x
SIZES = {"PhysicalSizeX": 0.5, "PhysicalSizeXUnit": "µm", "PhysicalSizeY": 500,
         "PhysicalSizeYUnit": "nm", "PhysicalSizeZ": 2.0, "PhysicalSizeZUnit": "µm"}
STEP = "0.5 0.5 2 um"


def pages_xml(first, ifd=None, count=None, file=None, uuid="urn:uuid:1"):
    place = f' IFD="{ifd}"' if ifd is not None else ""
    place += f' PlaneCount="{count}"' if count is not None else ""
    z, c, t = first
    inner = f'<UUID FileName="{file}">{uuid}</UUID>' if file else ""
    return f'<TiffData FirstZ="{z}" FirstC="{c}" FirstT="{t}"{place}>{inner}</TiffData>'


def image_xml(pages, sizes=(4, 3, 2), order="XYZCT", name="one", more=""):
    z, c, t = sizes
    channels = "".join(f'<Channel ID="Channel:0:{i}" Name="stain {i}"/>' for i in range(c))
    return (f'<Image ID="Image:{name}" Name="{name}"><Pixels ID="P" DimensionOrder="{order}" '
            f'Type="uint16" SizeX="10" SizeY="9" SizeZ="{z}" SizeC="{c}" SizeT="{t}" {more}>'
            f'{channels}{"".join(pages)}</Pixels></Image>')


def ome_xml(images, uuid="urn:uuid:1"):
    return ('<?xml version="1.0" encoding="UTF-8"?><OME xmlns="http://www.openmicroscopy.org/'
            f'Schemas/OME/2016-06" UUID="{uuid}">{"".join(images)}</OME>')


def whole(to):
    """Files of one image, in every order of planes, as tifffile describes them."""
    for order in ("TCZYX", "TZCYX", "CTZYX", "CZTYX", "ZTCYX", "ZCTYX"):
        name = f"ome-{order}.ome.tif"
        axes = ["TCZYX".index(axis) for axis in order]
        to.write(name, numpy.ascontiguousarray(DATA.transpose(axes)), ome=True,
                 photometric="minisblack",
                 metadata={"axes": order, "Channel": {"Name": ["red", "green", "blue"]}, **SIZES})
        to.refuse(name, "has 3 channels: 0 (red), 1 (green), 2 (blue)")
        to.refuse(name, "has 2 times", channel=0)
        to.refuse(name, "input.time (--time) is 2", channel=0, time=2)
        for c in range(3):
            to.note(name, DATA[1, c], STEP, channel=c, time=1)
    rgb = numpy.moveaxis(DATA[0], 0, -1)
    to.write("ome-rgb.ome.tif", rgb, ome=True, photometric="rgb", metadata={"axes": "ZYXS"})
    to.note("ome-rgb.ome.tif", rgb[..., 2], channel=2)
    to.write("ome-times.ome.tif", DATA[:, 0, 0], ome=True, metadata={"axes": "TYX"})
    to.note("ome-times.ome.tif", DATA[:, 0, 0])
    to.note("ome-times.ome.tif", DATA[1, 0, 0], time=1)
    full = DATA[0, 0].repeat(8, 1).repeat(8, 2)
    with tifffile.TiffWriter(to.path_of("pyramid.ome.tif")) as out:
        out.write(full, subifds=2, tile=(16, 16), metadata={"axes": "ZYX", **SIZES},
                  photometric="minisblack")
        out.write(full[:, ::2, ::2], subfiletype=1, tile=(16, 16), photometric="minisblack")
        out.write(full[:, ::4, ::4], subfiletype=1, tile=(16, 16), photometric="minisblack")
    to.note("pyramid.ome.tif", full, STEP)
    to.note("pyramid.ome.tif", full[:, ::2, ::2], "1 1 2 um", level=1)
    to.note("pyramid.ome.tif", full[:, ::4, ::4], "2 2 2 um", level=2)
    to.refuse("pyramid.ome.tif", "has 3 levels: 0 (80 x 72), 1 (40 x 36), 2 (20 x 18)", level=3)


def blocks(to):
    """Descriptions of our own: pages in odd places."""
    planes = DATA.reshape(-1, 9, 10)  # XYZCT
    backwards = [pages_xml((i % 4, i // 4 % 3, i // 12), 23 - i) for i in range(24)]
    to.write_plain("backwards.ome.tif", planes[::-1], ome_xml([image_xml(backwards)]))
    to.note("backwards.ome.tif", DATA[0, 1], channel=1, time=0)
    halves = [pages_xml((0, 0, 0), 12, 12), pages_xml((0, 0, 1), 0, 12)]
    swapped = numpy.concatenate([planes[12:], planes[:12]])
    to.write_plain("halves.ome.tif", swapped, ome_xml([image_xml(halves)]))
    to.note("halves.ome.tif", DATA[1, 2], channel=2, time=1)
    to.write_plain("unsaid.ome.tif", planes, ome_xml([image_xml([])]))
    to.note("unsaid.ome.tif", DATA[1, 0], channel=0, time=1)
    to.write_plain("lacking.ome.tif", planes, ome_xml([image_xml(backwards[:-1])]))
    to.refuse("lacking.ome.tif", "names no page for slice 3 of 4", channel=2, time=1)
    to.write_plain("twice.ome.tif", planes, ome_xml([image_xml(backwards + backwards[-1:])]))
    to.refuse("twice.ome.tif", "names two pages for slice", channel=2, time=1)
    to.write_plain("beyond.ome.tif", planes[:6], ome_xml([image_xml(backwards[::-1])]))
    to.refuse("beyond.ome.tif", "has 6 pages, but the OME-XML names page", channel=0, time=0)
    to.write_plain("unlike.ome.tif", planes[:, :8], ome_xml([image_xml([])]))
    to.refuse("unlike.ome.tif", "10 x 8 pixels")
    to.write_plain("broken.ome.tif", planes, ome_xml([image_xml([])])[:-9])
    to.refuse("broken.ome.tif", "its OME-XML cannot be read")
    to.write_plain("no-order.ome.tif", planes, ome_xml([image_xml([], order="XYZZT")]))
    to.refuse("no-order.ome.tif", "DimensionOrder 'XYZZT'")
    to.write_plain("no-size.ome.tif", planes, ome_xml([image_xml([], sizes=(0, 3, 2))]))
    to.refuse("no-size.ome.tif", "SizeZ: expected a number of 1 or more")
    to.write_plain("vast.ome.tif", planes, ome_xml([image_xml([], sizes=(2000000000, 3, 200000))]))
    to.refuse("vast.ome.tif", "announces 2000000000 x 3 x 200000 planes")
    to.write_plain("many.ome.tif", planes, ome_xml([image_xml([], sizes=(2000000000, 3, 1))]))
    to.refuse("many.ome.tif", "has 24 pages, but the OME-XML names page", channel=0)
    images = [image_xml([pages_xml((0, 0, 0), 0, 4)], (4, 1, 1), name="left"),
              image_xml([pages_xml((0, 0, 0), 4, 4)], (4, 1, 1), name="right")]
    to.write_plain("images.ome.tif", planes[:8], ome_xml(images))
    to.refuse("images.ome.tif", "holds 2 images: 0 (left: 10 x 9 x 4")
    to.refuse("images.ome.tif", "input.dataset (--dataset) is 'middle'", dataset="middle")
    to.note("images.ome.tif", planes[:4], dataset="left")
    to.note("images.ome.tif", planes[4:8], dataset="1")


def several_files(to):
    os.makedirs(to.path_of("set"))
    pages, names = [], []
    for z in range(4):
        names.append(f"plane{z}.ome.tif")
        pages.append(pages_xml((z, 0, 0), 0, 3, names[-1], f"urn:uuid:{z}"))
    for z, name in enumerate(names):
        xml = ome_xml([image_xml(pages, (4, 3, 1), order="XYCZT")], f"urn:uuid:{z}")
        to.write_plain("set/" + name, DATA[0, :, z], xml)
    for name in ("set/plane0.ome.tif", "set/plane3.ome.tif"):
        to.note(name, DATA[0, 1], channel=1)
    gone = [pages_xml((z, 0, 0), 0, 1, f"gone{z}.ome.tif", f"urn:uuid:{z}") for z in range(4)]
    to.write_plain("gone0.ome.tif", DATA[0, 0, :1], ome_xml([image_xml(gone, (4, 1, 1))],
                                                            "urn:uuid:0"))
    cases = len(to.cases)
    to.refuse("gone0.ome.tif", "gone1.ome.tif, which is missing")
    out = [pages_xml((0, 0, 0), 0, 4, "../out.tif", "urn:uuid:9"),
           pages_xml((0, 1, 0), 0, 4, "other.tif", "urn:uuid:8")]
    to.write_plain("out.ome.tif", DATA[0, 0], ome_xml([image_xml(out, (4, 2, 1))]))
    to.refuse("out.ome.tif", "../out.tif")
    assert len(to.cases) == cases + 2
    renamed = [pages_xml((0, 0, 0), 0, 4, "before.ome.tif", "urn:uuid:7")]
    to.write_plain("after.ome.tif", DATA[0, 0], ome_xml([image_xml(renamed, (4, 1, 1))], ""))
    to.note("after.ome.tif", DATA[0, 0])
    held = [pages_xml((0, 0, 0), 0, 4, "held.ome.tif", "urn:uuid:5")]
    with open(to.path_of("all.companion.ome"), "w", encoding="utf-8") as file:
        file.write(ome_xml([image_xml(held, (4, 1, 1))], "urn:uuid:6"))
    pointer = '<BinaryOnly MetadataFile="all.companion.ome" UUID="urn:uuid:6"/>'
    to.write_plain("held.ome.tif", DATA[0, 0], ome_xml([pointer], "urn:uuid:5"))
    to.note("held.ome.tif", DATA[0, 0])
    to.note("all.companion.ome", DATA[0, 0])
    to.write_plain("lost.ome.tif", DATA[0, 0], ome_xml([pointer.replace("all.", "no.")]))
    to.refuse("lost.ome.tif", "no.companion.ome, which is missing")


def write_all(to):
    whole(to)
    blocks(to)
    several_files(to)
