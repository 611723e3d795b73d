# voxweld as tasks of Snakemake: every stage but merge cut into parts, each of them one plain command. Needs
# Snakemake and the program, and on several machines a file system that they share.
#
#   snakemake -s configs/workflow.smk --cores 8 --config config=scan.toml parts=16
#
# --config takes (in parentheses: what holds if it is not given)
#   config    the config file of the run
#   parts     into how many parts the stages but merge are cut (4)
#   refine    0 where the mesh is not refined: simplify.refine is "off", or is "auto" (its default) and
#             simplify.enabled is false or simplify.topology "free" (1)
#   mend      0 where simplify.intersections is "report" or "ignore": no mend and remend (1)
#   seams     0 where that is so and simplify.refine is "repair": no seams either (1)
#   target    1 where the config has simplify.triangles or simplify.ratio: adds survey and recount (0)
#   levels    1 where output.levels is given and more than 1: adds levels (0)
#   voxweld   the program (the one on PATH)
#   done      the folder of the done-marks, one file a command (CONFIG without .toml, and .done)
#   threads   of a command (4)
#   mem_mb    memory of a command: what the config says of run.memory, and a margin (4608)
#   runtime   minutes a command may take, for clusters that want to know (240)
#
# Snakemake's own options say where commands run, such as --profile, --cluster and --jobs; threads
# and resources have the names that profiles use. A command that is run again does what is missing
# of its part and no more, so --retries and --rerun-incomplete are safe. Commands that left their
# mark are not run again unless the config was edited; whoever removes the work or the output folder
# removes the marks too. Results are those of `voxweld run`, which may as well go on where this was
# stopped.
import os
import shlex

if "config" not in config:
    raise WorkflowError("which config file? --config config=FILE")

CONFIG = os.path.abspath(str(config["config"]))
PARTS = int(config.get("parts", 4))
DONE = os.path.abspath(str(config.get("done", os.path.splitext(CONFIG)[0] + ".done")))
THREADS = int(config.get("threads", 4))
VOXWELD = shlex.quote(str(config.get("voxweld", "voxweld")))


def is_set(name, default):
    return str(config.get(name, default)).lower() not in ("0", "false", "off", "no", "")


TARGET = is_set("target", 0)
REFINE = TARGET or is_set("refine", 1)
SEAMS = is_set("seams", 1)
MEND = SEAMS and is_set("mend", 1)
LEVELS = is_set("levels", 0)

if PARTS < 1:
    raise WorkflowError("parts is {}: at least 1 is needed".format(PARTS))


def mark(name):
    return os.path.join(DONE, name)


def parts_of(stage):
    return expand(mark("{stage}-{part}-of-{parts}"), stage=stage, part=range(PARTS), parts=PARTS)


# What a stage works on: the mark of the one before.
BEFORE = {
    "ingest": CONFIG,
    "build": mark("ingest"),
    "stitch": mark("merge"),
    "encode": parts_of("stitch"),
}
# From refine on a part needs the whole stage before it.
if REFINE:
    BEFORE.update(
        {
            "refine": parts_of("stitch"),
            "seams": parts_of("refine"),
            "mend": parts_of("seams"),
            "remend": parts_of("mend"),
            "retile": parts_of("remend" if MEND else "seams" if SEAMS else "refine"),
            "encode": parts_of("retile"),
        }
    )
# A unit of refine needs the counts of all units of survey, to choose its tolerance by.
if TARGET:
    BEFORE.update(
        {
            "survey": parts_of("stitch"),
            "refine": parts_of("survey"),
            "recount": parts_of("refine"),
            "seams": parts_of("recount"),
        }
    )
# Levels wait for each other: one command does them all.
if LEVELS:
    BEFORE["encode"] = mark("levels")
# What the closing command of a stage waits for.
CLOSES = {
    "ingest": parts_of("ingest"),
    "merge": parts_of("build"),
    "levels": parts_of("retile"),
    "encode": parts_of("encode"),
}


rule all:
    input:
        mark("encode"),


# K of N: every N-th unit of the stage from the K-th on.
rule part:
    input:
        lambda wildcards: BEFORE[wildcards.stage],
    output:
        touch(mark("{stage}-{part}-of-{parts}")),
    wildcard_constraints:
        stage="ingest|build|stitch|survey|refine|recount|seams|mend|remend|retile|encode",
        part="[0-9]+",
        parts=str(PARTS),
    threads: THREADS
    resources:
        mem_mb=int(config.get("mem_mb", 4608)),
        runtime=int(config.get("runtime", 240)),
    params:
        command=VOXWELD,
        config=shlex.quote(CONFIG),
    shell:
        "{params.command} {wildcards.stage} {params.config}"
        " --part {wildcards.part}/{wildcards.parts} --set run.threads={threads}"


# What belongs to the whole of a stage: ingest closes the brick store, encode writes the manifest
# and the merged mesh, merge is one piece anyway, and so is levels.
rule whole:
    input:
        lambda wildcards: CLOSES[wildcards.stage],
    output:
        touch(mark("{stage}")),
    wildcard_constraints:
        stage="ingest|merge|levels|encode",
    threads: THREADS
    resources:
        mem_mb=int(config.get("mem_mb", 4608)),
        runtime=int(config.get("runtime", 240)),
    params:
        command=VOXWELD,
        config=shlex.quote(CONFIG),
    shell:
        "{params.command} {wildcards.stage} {params.config} --set run.threads={threads}"
