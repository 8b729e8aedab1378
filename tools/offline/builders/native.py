"""Stand-in for the builder of PlatformIO's `native` platform: programs for the machine it runs on."""

from SCons.Script import AlwaysBuild, Default, DefaultEnvironment

env = DefaultEnvironment()
program = env.BuildProgram()
run = env.VerboseAction("$SOURCE $PROGRAM_ARGS", "Running $SOURCE")

env.AddPlatformTarget("exec", program, run, "Execute")
AlwaysBuild(env.Alias("buildprog", program))
AlwaysBuild(env.Alias("upload", program, run))
AlwaysBuild(env.Alias("size", program, env.VerboseAction("size $SOURCE", "Sizing $SOURCE")))
Default([program])
