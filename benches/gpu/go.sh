# Compiles and runs all measurements: `OUT=FOLDER bash go.sh`. Each stage has a limit of time and is independent of the others.
# ARCH: the architecture of the card; RUN=0: compile only; JOBS: compilations at a time.
set +e
cd "$(dirname "$0")"
OUT=${OUT:-out}
ARCH=${ARCH:-native}
JOBS=${JOBS:-16}
NVCC=${NVCC:-$(command -v nvcc || echo /usr/local/cuda/bin/nvcc)}
mkdir -p "$OUT" bin
HOST="-O3 -march=native -std=c++17"
LIBRARIES="$(dirname "$(readlink -f "$(command -v "$NVCC")")")/../lib"
DEVICE="-O3 -std=c++17 -arch=$ARCH -Xcompiler -O2 -Xcompiler -pthread -lpthread -L$LIBRARIES"

# name joints base-parameters postures redundant
ARMS="panda7:7:42:8:1 ur5:6:17:8:0 scara:4:11:2:0"

# A limit of seconds, then the command.
stage() {
    timeout "$@"
    local code=$?
    [ $code = 0 ] || echo "FAILED ($code): ${*:2:1} ${*: -3}"
}

# The host's compiler fuses nothing by the header itself. In `contracted` nvcc fuses as it likes.
build_arm() { # arm joints base arithmetic
    local real=double flags="-fmad=false -DARMGEN_FMAD=0" header=$4
    [ "$4" = f64 ] || real=float
    [ "$4" != contracted ] || { flags="-DARMGEN_FMAD=1"; header=f32; }
    local all="-DROBOT=$1 -DREAL=$real -DDOF=$2 -DBASE=$3 -DHEADER=\"$1_$header.cuh\""
    stage 200 g++ $HOST $all -c host.cpp -o "bin/$1_$4.o"
    stage 240 $NVCC $DEVICE $flags $all -DARM="\"$1\"" -DARITHMETIC="\"$4\"" bench.cu "bin/$1_$4.o" -o "bin/$1_$4"
}

build_ik() { # arm joints postures redundant arithmetic
    local real=double
    [ "$5" = f64 ] || real=float
    local all="-DROBOT=$1 -DREAL=$real -DDOF=$2 -DMOST=$3 -DREDUNDANT=$4 -DHEADER=\"$1_$5.cuh\" -DIK_HEADER=\"$1_$5_ik.h\""
    stage 200 g++ $HOST $all -c ik_host.cpp -o "bin/$1_$5_ik.o"
    stage 240 $NVCC $DEVICE -fmad=false -DARMGEN_FMAD=0 $all -DARM="\"$1\"" -DARITHMETIC="\"$5\"" ik.cu "bin/$1_$5_ik.o" -o "bin/$1_$5_ik"
}

build_grid() {
    [ -f grid.cuh ] && stage 240 $NVCC -diag-suppress 177 -w $DEVICE -DARMGEN_FMAD=1 -DHEADER="\"panda7_fma.cuh\"" grid.cu -o bin/grid
}

arithmetics() { echo f64 f32 fma; [ "$1" != panda7 ] || echo contracted; }

limit() { while [ "$(jobs -r | wc -l)" -ge "$JOBS" ]; do sleep 0.2; done; }

begin=$(date +%s)
for arm in $ARMS; do
    IFS=: read -r name joints base postures redundant <<< "$arm"
    for arithmetic in f64 f32; do
        limit; build_ik $name $joints $postures $redundant $arithmetic &
    done
    for arithmetic in $(arithmetics $name); do
        limit; build_arm $name $joints $base $arithmetic &
    done
done
limit; build_grid &
wait
echo "compiled in $(($(date +%s) - begin)) s: $(ls bin | grep -vc '\.o$') programs"
[ "${RUN:-1}" = 1 ] || exit 0

{ nvidia-smi --query-gpu=name,driver_version,clocks.max.sm,clocks.max.memory,power.limit --format=csv; $NVCC --version | tail -2; g++ --version | head -1; lscpu | grep "Model name"; nproc; } > "$OUT/machine.txt" 2>&1
cat "$OUT/machine.txt"
for arm in $ARMS; do
    name=${arm%%:*}
    for arithmetic in $(arithmetics $name); do
        stage 40 "bin/${name}_$arithmetic" "$OUT/speed_${name}_$arithmetic.csv" "$OUT/latency_${name}_$arithmetic.csv"
    done
done 2>&1 | tee "$OUT/arms.txt"
for arm in $ARMS; do
    name=${arm%%:*}
    for arithmetic in f64 f32; do
        stage 30 "bin/${name}_${arithmetic}_ik" "$OUT/speed_${name}_${arithmetic}_ik.csv"
    done
done 2>&1 | tee "$OUT/ik.txt"
stage 60 bin/grid "$OUT/latency_grid.csv" 2>&1 | tee "$OUT/grid.txt"
{ echo "arm,arithmetic,function,layout,states,ms,G states/s,G states/s of a copy,fraction of the copy,GB/s,compared,differing,worst difference,largest"; cat "$OUT"/speed_*.csv; } > "$OUT/gpu.csv"
{ echo "library,arm,arithmetic,function,states,threads,us in a loop,us in a graph,us waited"; cat "$OUT"/latency_*.csv; } > "$OUT/gpu-latency.csv"
echo "all in $(($(date +%s) - begin)) s"
